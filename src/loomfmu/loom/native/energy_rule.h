/* The rule of the shaft's energy: what the motor delivers is found again in the shaft, its mechanisms and outside torques. */

/* Its signals: six of the shaft, then three of each load. Its numbers: the bound, the law of a spline cam, and of each load
 * whether its work counts at the shaft, and the law of its drive. Its words: the torque and the number of each load. */
enum { VELOCITY, ACCELERATION, MOTOR_WORK, LOAD_WORK, OTHER_WORK, KINETIC_ENERGY, OF_SHAFT };
enum { TORQUE, WORK, PASSED, OF_LOAD };

struct load { /* a mechanism on the shaft: its torque, the work that it states for it, and the part without work */
    int torque, work, passed;
    double counts, law;
    const char *name, *number;
};

/* A line of some words. */
static const char *line_of(struct run *run, const char *words, ptrdiff_t line)
{
    for (; line > 0; line--)
        words += strcspn(words, "\n") + 1;
    return text(run, "%.*s", (int)strcspn(words, "\n"), words);
}

static struct load *loads_of(struct run *run, const struct call *call)
{
    const ptrdiff_t count = call->forms - 1;
    struct load *loads = take(run, &run->scratch, (size_t)count * sizeof *loads);
    for (ptrdiff_t place = 0; place < count; place++) {
        const ptrdiff_t signal = OF_SHAFT + OF_LOAD * place;
        const double *number = call->number + 2 + 2 * place;
        loads[place] = (struct load){signal_of(call, signal + TORQUE), signal_of(call, signal + WORK),
                                     signal_of(call, signal + PASSED), number[0], number[1],
                                     line_of(run, call->words, 2 * place), line_of(run, call->words, 2 * place + 1)};
    }
    return loads;
}

static bool has_work(const struct load *load)
{
    return load->work >= 0 && load->counts != 0.0;
}

static double *new_values(struct run *run)
{
    return take(run, &run->scratch, (size_t)run->samples * sizeof(double));
}

/* The place of the largest magnitude, the first if several have it; NaN is larger than all. */
static ptrdiff_t largest_of(const double *values, ptrdiff_t count)
{
    ptrdiff_t found = 0;
    for (ptrdiff_t place = 1; place < count; place++)
        if (!isnan(values[found]) && !(fabs(values[place]) <= fabs(values[found])))
            found = place;
    return found;
}

/* A sum of which rounding stays small: of both halves, and of every eighth value. */
static double sum_of(const double *values, ptrdiff_t count)
{
    double sums[8] = {0.0};
    const ptrdiff_t half = count / 2 - count / 2 % 8, whole = count - count % 8;
    if (count > 128)
        return sum_of(values, half) + sum_of(values + half, count - half);
    for (ptrdiff_t place = 0; place < whole; place++)
        sums[place % 8] += values[place];
    double sum = ((sums[0] + sums[1]) + (sums[2] + sums[3])) + ((sums[4] + sums[5]) + (sums[6] + sums[7]));
    for (ptrdiff_t place = whole; place < count; place++)
        sum += values[place];
    return sum;
}

/* The integral from the start to each sample, of fourth order: trapezoids, corrected by the slopes; 0 for two samples. */
static double *integral_of(struct run *run, struct column time, struct column values, ptrdiff_t count)
{
    double *integral = new_values(run), before = 0.0;
    const bool even = count > 2 && is_even(time, count);
    integral[0] = 0.0;
    for (ptrdiff_t place = 0; place < count; place++) {
        const double slope = count > 2 ? slope_at(time, values, count, place, even) : 0.0;
        if (place > 0) {
            const double h = at_sample(time, place) - at_sample(time, place - 1);
            const double sum = at_sample(values, place) + at_sample(values, place - 1);
            integral[place] = count > 2 ? integral[place - 1] + (0.5 * h * sum - h * h / 12.0 * (slope - before)) : 0.0;
        }
        before = slope;
    }
    return integral;
}

/* How far the shaft's velocity is from the integral of its acceleration, as a share of it.
 *
 * Nothing but rounding for loads whose work is known; of second order in the step for others. */
static double slip(struct run *run, const struct call *call)
{
    const int velocity = signal_of(call, VELOCITY);
    const struct column acceleration = run->signals[signal_of(call, ACCELERATION)].column;
    const double fastest = curve(run, velocity)->largest;
    double *off = integral_of(run, run->time, acceleration, run->samples);
    for (ptrdiff_t place = 0; place < run->samples; place++)
        off[place] = sample_of(run, velocity, place) - sample_of(run, velocity, 0) - off[place];
    return fastest != 0.0 ? fabs(off[largest_of(off, run->samples)]) / fastest : 0.0;
}

struct gap { /* the largest difference of two works, what of it the steps may explain, and its place */
    double most, allowed;
    ptrdiff_t place;
};

/* The largest difference of the work that a load states from that of its torque.
 *
 * The steps explain twice what half of the samples change the integral by: about 15 times its error for a torque that its
 * samples resolve, but what a blow between two samples does may lie beyond. And a torque belongs to the shaft's
 * acceleration, a work to its velocity: where these differ by a share, the work `I w^2 / 2` of a mass differs by up to
 * four times this share, `2 I w` times the largest difference. */
static struct gap gap_of(struct run *run, const struct call *call, const struct load *load, double slipped)
{
    const ptrdiff_t samples = run->samples, halves = (samples + 1) / 2;
    const struct motion *work = curve(run, load->work);
    double *power = new_values(run), *off = new_values(run);
    for (ptrdiff_t place = 0; place < samples; place++) {
        const double passed = load->passed < 0 ? 0.0 : sample_of(run, load->passed, place);
        power[place] = (sample_of(run, load->torque, place) - passed) * sample_of(run, signal_of(call, VELOCITY), place);
    }
    const struct column all = {(const char *)power, sizeof *power}, second = {all.first, 2 * all.stride};
    const struct column time = {run->time.first, 2 * run->time.stride};
    const double *done = integral_of(run, run->time, all, samples);
    double *halved = integral_of(run, time, second, halves);
    for (ptrdiff_t place = 0; place < samples; place++)
        off[place] = sample(work, 1, place) - sample(work, 1, 0) - done[place];
    for (ptrdiff_t place = 0; place < halves; place++)
        halved[place] -= done[2 * place];
    const ptrdiff_t at = largest_of(off, samples);
    const double rest = 4.0 * slipped * (work->highest - work->lowest) + 1e-12 * work->largest;
    struct gap found = {fabs(off[at]), 2.0 * fabs(halved[largest_of(halved, halves)]) + rest, at};
    return found;
}

/* A note on the torques whose work the shaft does not know; empty if it knows all. */
static const char *without_work(struct run *run, const struct load *loads, ptrdiff_t count)
{
    const char *names = "";
    for (ptrdiff_t place = 0; place < 2 * count; place++) {
        const struct load *load = &loads[place % count];
        const bool own = place < count, passes = has_work(load) && load->passed >= 0;
        if (own ? !has_work(load) : passes && curve(run, load->passed)->largest != 0.0)
            names = text(run, "%s%s%s", names, *names == '\0' ? "" : ", ", own ? load->name : run->signals[load->passed].name);
    }
    return *names == '\0' ? "" : text(run, "work by the torque alone, of second order in the step: %s", names);
}

/* A note on the works that the shaft counts for a torque although they do not come from its mechanism; empty if none. */
static const char *unwired(struct run *run, const struct load *loads, ptrdiff_t count)
{
    const char *all = "";
    for (const struct load *load = loads; load < loads + count; load++)
        if (load->work < 0 && load->counts == 1.0)
            all = text(run, "%s%sshaft.use_work_%s = true, but shaft.work_%s is not wired", all, *all == '\0' ? "" : "; ",
                       load->number, load->number);
    return all;
}

/* The energy that is missing at each sample, since the start. */
static double *missing_of(struct run *run, const struct call *call, const struct load *loads, ptrdiff_t count)
{
    double *missing = new_values(run), first = 0.0;
    for (ptrdiff_t place = 0; place < run->samples; place++) {
        double stored = sample_of(run, signal_of(call, KINETIC_ENERGY), place);
        for (const struct load *load = loads; load < loads + count; load++)
            if (has_work(load))
                stored += sample_of(run, load->work, place);
        first = place == 0 ? stored : first;
        missing[place] = sample_of(run, signal_of(call, MOTOR_WORK), place) - sample_of(run, signal_of(call, OTHER_WORK), place)
                         - (stored - first);
    }
    return missing;
}

/* The work that the shaft and its loads exchange, to and fro, in a revolution. */
static double exchanged(struct run *run, const struct call *call)
{
    const struct motion *turning = shaft_of(run);
    const int work = signal_of(call, LOAD_WORK);
    double *steps = new_values(run);
    for (ptrdiff_t place = 0; place + 1 < run->samples; place++)
        steps[place] = fabs(sample_of(run, work, place + 1) - sample_of(run, work, place));
    return sum_of(steps, run->samples - 1) / larger((turning->highest - turning->lowest) / TURN, 1.0);
}

/* The largest energy that is missing at any sample, or in the work of a load, as a share of what is exchanged. It judges the
 * books of the run, however long that is. */
static void judge_energy(struct run *run, const struct call *call, struct answer *answer)
{
    const ptrdiff_t count = call->forms - 1;
    const struct load *loads = loads_of(run, call);
    const double *missing = missing_of(run, call, loads, count), through = exchanged(run, call), slipped = slip(run, call);
    const char *loose = unwired(run, loads, count), *said = without_work(run, loads, count), *why = "";
    ptrdiff_t at = largest_of(missing, run->samples);
    double most = fabs(missing[at]);
    if (sample_of(run, signal_of(call, VELOCITY), 0) == 0.0)
        why = "the steps may be too coarse for the start from rest: take more";
    for (ptrdiff_t each = 0; each < count; each++) {
        const struct load *load = &loads[each];
        const struct gap gap = has_work(load) ? gap_of(run, call, load, slipped) : (struct gap){0.0, 0.0, 0};
        if (!(gap.most - gap.allowed > most))
            continue;
        most = gap.most - gap.allowed;
        at = gap.place;
        answer->form = (int)each + 1;
        said = text(run, "its work is %.3g J off %s; the steps explain %.2g J", gap.most, run->signals[load->work].name,
                    gap.allowed);
        why = load->law == call->number[1] ? "the velocity of a spline_cam jumps: its impulse is in the work, but in no torque"
                                           : "take more steps: the gap shrinks if the torque is right";
    }
    const bool known = through > 0.0 && *loose == '\0';
    answer->any_length = true;
    answer->time = time_at(run, at);
    answer->worst = known ? most / through : NAN;
    note(run, answer, known ? said : through > 0.0 ? loose : "the shaft does no work in this run", PLAIN);
    if (known && most > answer->bound * through)
        note(run, answer, why, PLAIN);
}
