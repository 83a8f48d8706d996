/* From what is judged to a verdict: what is not known, what the run does not show, and why a claim is undecided. */

static const double MET = 1e-12; /* of worst value or bound: a bound met by construction is met to rounding */
static const char AT_SAMPLES[] = "; set at_samples = true in the claim to judge these alone";
static const char COARSE_NOTE[] = "the samples are too far apart to be sure; take more steps";

enum weight { PLAIN, DOUBTFUL, UNKNOWN }; /* a note: leaves a claim undecided that would hold; or unless a sample fails it */

struct note {
    const char *words;
    enum weight weight;
};

struct form { /* of a verdict: its signal, -1 for what is computed of several */
    int signal;
    double sense;  /* 1 if the worst value must be at least the bound, -1 if at most */
    bool as_it_is; /* its number is one of its signal, which otherwise only names where to look */
};

/* A question: a rule with its forms, signals and numbers, and the pegs of the weave; the run has the shafts that matter.
 * judging.py says how it is written. */
struct call {
    int rule;
    ptrdiff_t forms, signals, numbers, pegs;
    const double *form, *signal, *number, *peg;
    const char *words; /* names for notes, in lines */
};

struct verdict { /* judging.py and live_judge.js have the same; all are numbers of one size */
    double holds, decided, form, bound, worst, time, angle, revolution, error, spread, distance, between;
};

struct answer { /* of a rule */
    double bound, worst, time, holds; /* 1 or 0, or NaN where the worst value decides */
    int form;
    bool fails_for_good, some_known; /* whatever the rest of a run shows; if `gaps` are all that count */
    bool any_length;                 /* the run need not show a whole revolution, nor the repeat of the weave */
    const char *unseen;              /* what the run does not show of all that it must, or an empty text */
    double between;                  /* what the curves between samples may be off by, as other steps may not show */
    double off;                      /* the same where only such a curve passes the bound, else NaN */
    struct stretches gaps;
    struct note *notes;
    ptrdiff_t count, space;
};

static int signal_of(const struct call *call, ptrdiff_t place)
{
    return place < call->signals ? (int)call->signal[place] : -1;
}

static struct form form_of(const struct call *call, int number)
{
    const double *form = call->form + 3 * number;
    struct form found = {(int)form[0], form[1], form[2] != 0.0};
    return found;
}

/* Add a note, unless it is empty. */
static void note(struct run *run, struct answer *answer, const char *words, enum weight weight)
{
    struct note added = {words, weight};
    if (*words == '\0')
        return;
    answer->notes = with_room(run, answer->notes, answer->count, &answer->space, sizeof added);
    answer->notes[answer->count++] = added;
}

/* Add the reason why the values of a motion between the samples are not known, if so, and what to do if they must not be. */
static void note_unknown_with(struct run *run, struct answer *answer, const struct motion *motion, const char *advice)
{
    if (!motion->finite)
        note(run, answer, text(run, "%s or its rate is not finite everywhere", motion->name), UNKNOWN);
    else if (!is_known(motion))
        note(run, answer, text(run, "%s is known only at the samples%s", motion->name, advice), UNKNOWN);
}

static void note_unknown(struct run *run, struct answer *answer, const struct motion *motion)
{
    note_unknown_with(run, answer, motion, "");
}

static void note_coarse(struct run *run, struct answer *answer, struct extreme found)
{
    if (found.coarse)
        note(run, answer, COARSE_NOTE, DOUBTFUL);
}

/* All notes as one text, each once. */
static const char *all_words(struct run *run, const struct note *notes, ptrdiff_t count)
{
    const char *all = "";
    for (ptrdiff_t place = 0; place < count; place++) {
        bool known = *notes[place].words == '\0';
        for (ptrdiff_t before = 0; before < place; before++)
            known = known || strcmp(notes[before].words, notes[place].words) == 0;
        if (!known)
            all = *all == '\0' ? notes[place].words : text(run, "%s; %s", all, notes[place].words);
    }
    return all;
}

/* How far the worst value is from the bound, negative on the wrong side of it; NaN where there is none, as in
 * traces/verdict.py. */
static double distance_from_bound(const struct verdict *verdict, double sense)
{
    const double distance = sense * (verdict->worst - verdict->bound);
    const bool known = verdict->decided != 0.0 ? distance < 0.0 : isfinite(verdict->error);
    return verdict->holds != 0.0 || known ? distance : NAN;
}

/* Take an error into a verdict: `spread` is what differs between resolutions, `model` what no resolution shows.
 *
 * Within the error of its bound it is undecided. A bound that all resolutions meet to rounding is met, where the model
 * itself is sure of the value: that is how a count, a value at rest or a limited one meets it. */
static void estimate(struct verdict *verdict, double sense, double error, double spread, double model)
{
    const double bound = verdict->bound, worst = verdict->worst;
    const double distance = distance_from_bound(verdict, sense);
    if (!isnan(verdict->error))
        error = larger(error, verdict->error);
    const double scale = larger(fabs(bound), fabs(worst));
    const bool met = fabs(distance) <= MET * scale && larger(spread, model) <= MET * fabs(worst);
    const bool decided = verdict->decided != 0.0 && (met || !(fabs(distance) <= error));
    verdict->error = error;
    verdict->spread = spread;
    verdict->decided = decided;
    verdict->holds = verdict->holds != 0.0 && decided;
    verdict->distance = distance_from_bound(verdict, sense);
}

/* What the run does not show of all that the claim takes; an empty text where it shows all. */
static const char *unseen_by(struct run *run, const struct call *call, const struct answer *answer)
{
    if (*run->cut_short != '\0' || answer->any_length)
        return run->cut_short;
    return *answer->unseen != '\0' ? answer->unseen : unwoven(run, call->peg, call->pegs);
}

/* The verdict, with the place on the shaft at its time.
 *
 * Unless `holds` says so, the worst value decides. Without one, NaN, a claim is undecided. So is one that holds as far as its
 * signal is known, where it has gaps, where the samples are too far apart, and where a note is doubtful; and one that does
 * not fail, or may not in the end, where the run was cut short or shows too little. */
static struct verdict concluded(struct run *run, const struct call *call, struct answer *answer)
{
    const struct form form = form_of(call, answer->form);
    struct motion *turning = shaft_of(run);
    struct verdict verdict = {.form = answer->form, .bound = answer->bound, .worst = answer->worst,
                              .time = answer->time, .angle = NAN, .revolution = NAN, .spread = NAN,
                              .between = answer->between};
    if (turning != NULL && too_coarse(turning))
        note(run, answer, COARSE_NOTE, DOUBTFUL);
    bool holds = isnan(answer->holds) ? form.sense * answer->worst >= form.sense * answer->bound : answer->holds != 0.0;
    if (!answer->some_known)
        answer->gaps = gaps(run, form.signal, NULL);
    const bool unknown = answer->gaps.count > 0, open = holds || !answer->fails_for_good;
    struct note *notes = take(run, &run->scratch, (size_t)(answer->count + 2) * sizeof *notes);
    const char *unseen = unseen_by(run, call, answer);
    notes[0] = (struct note){"", PLAIN};
    notes[1] = (struct note){unknown ? unknown_note(run, form.signal, answer->gaps.list[0].start) : "", DOUBTFUL};
    if (answer->count > 0)
        memcpy(notes + 2, answer->notes, (size_t)answer->count * sizeof *notes);
    bool doubted = false;
    for (ptrdiff_t place = 1; place < answer->count + 2; place++)
        doubted = doubted || (*notes[place].words != '\0' && notes[place].weight >= (holds ? DOUBTFUL : UNKNOWN));
    const bool decided = !(isnan(answer->worst) || (open && (doubted || *unseen != '\0')));
    if (!decided) {
        notes[0].words = unseen;
        if (!isnan(answer->worst) && (unknown || (open && *unseen != '\0')))
            verdict.worst = verdict.time = NAN;
    }
    if (turning != NULL && isfinite(verdict.time)) {
        struct place place = place_at(run, verdict.time);
        verdict.angle = place.angle;
        verdict.revolution = place.revolution;
    }
    run->note = all_words(run, notes, answer->count + 2);
    verdict.holds = holds && decided;
    verdict.decided = decided;
    verdict.error = decided ? NAN : INFINITY;
    verdict.distance = distance_from_bound(&verdict, form.sense);
    if (verdict.holds != 0.0 && !isnan(answer->off))
        estimate(&verdict, form.sense, answer->off, answer->off, 0.0);
    return verdict;
}
