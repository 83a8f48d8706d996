/* The functions of the library, by the machine's RULES: one text for the command, in a library, and for a page, as
 * WebAssembly.
 *
 * Signals go by the numbers in which they are added. A question is a list of numbers: its rule, then the forms of its
 * verdict, its signals and its numbers, each list after its length, see judging.py. */

static bool is_by(const struct call *call, judge_by *judge)
{
    return RULES[call->rule].judge == judge;
}

/* ---- beside the verdict */

/* What the number of a verdict may be off by whatever the steps, as a signal beside it says. */
static double left_by_model(struct run *run, const struct call *call, const struct verdict *verdict)
{
    const struct form form = form_of(call, (int)verdict->form);
    struct judged judged = {.always = true};
    if (form.signal < 0 || !form.as_it_is)
        return 0.0;
    if (is_by(call, judge_bounded))
        judged = when_judged(run, call);
    return off_by(run, form.signal, verdict->worst, verdict->time, judged.always ? NULL : &judged.within);
}

#if defined(_WIN32)
#define EXPORT(name) __declspec(dllexport)
#elif defined(__wasm__)
#define EXPORT(name) __attribute__((export_name(#name)))
#else
#define EXPORT(name) __attribute__((visibility("default")))
#endif

#ifdef __wasm__ /* what a page has to be given */

EXPORT(allocate) void *allocate(size_t size)
{
    return malloc(size);
}

EXPORT(release) void release_memory(void *memory)
{
    free(memory);
}

#endif

/* A run of so many samples, with an address in bytes and a stride for their times. `cut_short` stays the caller's, as do
 * all texts and samples. Without memory there is none. */
EXPORT(run_new) struct run *run_new(ptrdiff_t samples, const char *time, ptrdiff_t stride, const char *cut_short)
{
    struct run *run = calloc(1, sizeof *run);
    if (run != NULL) {
        run->samples = samples;
        run->time = (struct column){time, stride};
        run->cut_short = cut_short;
        run->shaft = -1;
        run->note = "";
    }
    return run;
}

EXPORT(run_free) void run_free(struct run *run)
{
    release(&run->scratch);
    release(&run->kept);
    free(run->signals);
    free(run);
}

/* Add a signal, which gets the next number; returns it, or -1 where no memory is left. */
EXPORT(run_add) int run_add(struct run *run, const char *name, const char *first, ptrdiff_t stride)
{
    if (run->count == run->space) {
        struct signal *moved = realloc(run->signals, (size_t)(2 * run->space + 16) * sizeof *moved);
        if (moved == NULL)
            return -1;
        run->signals = moved;
        run->space = 2 * run->space + 16;
    }
    run->signals[run->count] = (struct signal){name, "", {first, stride}, -1, -1, -1, -1, -1, {NULL}};
    if (strcmp(name, "shaft.angle") == 0)
        run->shaft = run->count;
    return run->count++;
}

/* Say which signals stand beside one, -1 for none, and what it is. */
EXPORT(run_beside)
void run_beside(struct run *run, int signal, int rate, int valid_if, int error, int low, int high, const char *about)
{
    struct signal *its = &run->signals[signal];
    *its = (struct signal){its->name, about, its->column, rate, valid_if, error, low, high, {NULL}};
}

EXPORT(run_note) const char *run_note(const struct run *run)
{
    return run->note;
}

/* The number of a rule, which begins its questions; -1 if there is none of this name. */
EXPORT(rule_of) int rule_of(const char *name)
{
    int rule = sizeof RULES / sizeof *RULES - 1;
    while (rule >= 0 && strcmp(RULES[rule].name, name) != 0)
        rule--;
    return rule;
}

static struct call call_of(struct run *run, const double *list, const char *words)
{
    struct call call = {.rule = (int)list[0], .words = words};
    call.forms = (ptrdiff_t)list[1];
    call.form = list + 2;
    list = call.form + 3 * call.forms;
    call.signals = (ptrdiff_t)list[0];
    call.signal = list + 1;
    list = call.signal + call.signals;
    call.numbers = (ptrdiff_t)list[0];
    call.number = list + 1;
    list = call.number + call.numbers;
    call.pegs = (ptrdiff_t)list[0];
    call.peg = list + 1;
    list = call.peg + call.pegs;
    run->moving = (ptrdiff_t)list[0] * (ptrdiff_t)sizeof *list / (ptrdiff_t)sizeof *run->movers;
    run->movers = (const struct mover *)(const void *)(list + 1);
    return call;
}

/* Judge a question, with a note of its own. Returns false where no memory is left. */
EXPORT(judge) bool judge(struct run *run, const double *question, const char *words, struct verdict *verdict)
{
    const struct call call = call_of(run, question, words);
    struct answer answer = {.bound = call.number[0], .worst = NAN, .time = NAN, .holds = NAN, .off = NAN};
    BEGIN(run, false);
    answer.fails_for_good = true;
    answer.unseen = short_run(run);
    RULES[call.rule].judge(run, &call, &answer);
    if (run->samples < 2)
        answer.unseen = "the run has no step";
    *verdict = concluded(run, &call, &answer);
    return true;
}

/* Take into a verdict what it may be off by: `spread` is what differs between resolutions. Changes of less than `noise`, than
 * a share of the value, or than `scatter` times how far the signal has moved, do not show the order of an error. */
EXPORT(settle)
bool settle(struct run *run, const double *question, struct verdict *verdict, double spread, double noise, double share,
            double scatter)
{
    const struct call call = call_of(run, question, "");
    const struct form form = form_of(&call, (int)verdict->form);
    const double sense = form.sense;
    BEGIN(run, false);
    const double model = left_by_model(run, &call, verdict); /* which includes the scatter */
    const double start = form.signal < 0 ? 0.0 : sample_of(run, form.signal, 0);
    const double least = larger(larger(noise, share * larger(fabs(verdict->worst), fabs(verdict->bound))),
                                model > 0.0 ? 0.0 : scatter * fabs(verdict->worst - start));
    const double left = larger(verdict->between, model);
    if (left == INFINITY) { /* a sample may fail the claim, but does not say by how much the signal does */
        estimate(verdict, sense, larger(spread, least), spread, model);
        verdict->error = INFINITY;
        verdict->distance = distance_from_bound(verdict, sense);
    } else {
        /* a shaft at rest meets 0 exactly; a bound met to rounding is met only if the curve is as sure */
        const bool exactly = verdict->worst == verdict->bound;
        estimate(verdict, sense, larger(larger(spread, left), least), spread, exactly ? model : left);
    }
    return true;
}

/* What a verdict may be off by whatever the steps; NaN where no memory is left. */
EXPORT(model_error) double model_error(struct run *run, const double *question, const struct verdict *verdict)
{
    const struct call call = call_of(run, question, "");
    BEGIN(run, NAN);
    return left_by_model(run, &call, verdict);
}

#ifndef __wasm__

/* Forget all that was found: there are so many samples of another run. */
EXPORT(run_renew) void run_renew(struct run *run, ptrdiff_t samples)
{
    run->samples = samples;
    release(&run->scratch);
    release(&run->kept);
    run->note = "";
    for (int signal = 0; signal < run->count; signal++)
        memset(run->signals[signal].motions, 0, sizeof run->signals[signal].motions);
}

/* Hand over as many times as there is room for; returns their number, -1 where no memory is left. */
static ptrdiff_t handed(struct times found, double *times, ptrdiff_t room)
{
    if (found.count > 0 && room > 0)
        memcpy(times, found.list, (size_t)(found.count < room ? found.count : room) * sizeof *times);
    return found.count;
}

/* Times at which a signal passes a level. */
EXPORT(passages) ptrdiff_t passages(struct run *run, int signal, double level, double *times, ptrdiff_t room)
{
    BEGIN(run, -1);
    return handed(crossings_of(curve(run, signal), level), times, room);
}

/* Times at which the shaft stands at an angle of its revolution. */
EXPORT(stands_at) ptrdiff_t stands_at(struct run *run, double angle, double *times, ptrdiff_t room)
{
    BEGIN(run, -1);
    return handed(times_at(run, angle), times, room);
}

/* The value of a signal at a time; NaN where no memory is left. */
EXPORT(value_at) double value_at(struct run *run, int signal, double time)
{
    BEGIN(run, NAN);
    return value_of(curve(run, signal), time);
}

/* Points of the polynomials of all intervals, one interval after the other; returns how many each has. */
EXPORT(points_of) ptrdiff_t points_of(struct run *run, int signal, double *points)
{
    BEGIN(run, -1);
    struct motion *motion = curve(run, signal);
    const ptrdiff_t count = 2 * motion->known;
    for (ptrdiff_t interval = 0; points != NULL && interval + 1 < motion->samples; interval++)
        (void)piece(motion, interval, points + count * interval);
    return count;
}

#endif
