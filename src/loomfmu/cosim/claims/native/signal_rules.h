/* Rules of claims on any signal, and on what a component holds of it. A rule takes its numbers in the order in which its
 * class gives them. */

static struct window window_of(const double *number)
{
    struct window window = {number[0], number[1]};
    return window;
}

static bool has_whole(const struct stretches *all)
{
    for (ptrdiff_t place = 0; place < all->count; place++)
        if (all->list[place].whole)
            return true;
    return false;
}

static void found_nothing(struct run *run, struct answer *answer, const char *why)
{
    answer->worst = answer->time = NAN;
    note(run, answer, why, PLAIN);
}

static void take_moment(struct answer *answer, struct moment found)
{
    answer->worst = found.value;
    answer->time = found.time;
}

static void take_extreme(struct answer *answer, struct extreme found)
{
    take_moment(answer, (struct moment){found.value, found.time});
    answer->between = known_doubt(found);
}

/* Where `sign` times a signal is lowest, with notes on how it is known. */
static struct extreme noted_extreme(struct run *run, struct answer *answer, int signal, double sign,
                                    const struct stretches *within)
{
    struct extreme found = lowest(curve(run, signal), sign, within);
    note_unknown(run, answer, curve(run, signal));
    note_coarse(run, answer, found);
    return found;
}

/* ---- a signal on one side of a bound: the bound, 1 if at the samples, 1 if in a window, this, 1 if the bound is a speed
 * that must not be negative */

struct judged { /* when a signal is judged, all the time or within, and when it is not known */
    bool always;
    struct stretches within, gaps;
};

static struct judged when_judged(struct run *run, const struct call *call)
{
    struct judged judged = {.always = call->number[2] == 0.0};
    if (!judged.always)
        judged.within = times_within(run, window_of(call->number + 3));
    const struct stretches *within = judged.always ? NULL : &judged.within;
    judged.gaps = gaps(run, signal_of(call, 0), within);
    if (judged.gaps.count > 0) {
        judged.within = without(run, &judged.gaps, within);
        judged.always = false;
    }
    return judged;
}

/* The worst value, with notes on how it is known. */
static struct extreme worst_of(struct run *run, const struct call *call, const struct judged *judged,
                               struct answer *answer)
{
    const int signal = signal_of(call, 0);
    const double sense = form_of(call, 0).sense;
    const struct stretches *within = judged->always ? NULL : &judged->within;
    struct motion *motion = curve(run, signal);
    if (within != NULL && within->count == 0)
        return NO_EXTREME;
    if (call->number[1] != 0.0) {
        struct extreme found = lowest_sample(motion, sense, within);
        if (motion->finite && isfinite(found.time))
            found.possible = sampled_possible(motion, sense, within);
        else
            found.possible = found.sure;
        if (!isfinite(found.time))
            note(run, answer, "no sample lies in that window; take more steps", PLAIN);
        return found;
    }
    struct extreme found = lowest(motion, sense, within);
    const int latch = sense > 0.0 ? run->signals[signal].lowest : run->signals[signal].highest;
    const bool fails = sense * found.sure < sense * answer->bound; /* whatever lies between the samples */
    if (is_known(motion) || latch < 0)
        note_unknown_with(run, answer, motion, fails ? "" : AT_SAMPLES);
    else if (latched(run, signal, sense, &found, within) >= 0)
        note(run, answer, text(run, "between the samples by %s", run->signals[latch].name), PLAIN);
    else if (!(sense * found.possible >= sense * answer->bound))
        note(run, answer, text(run, "%s was reached elsewhere, and nothing else tells of the time between these samples",
                               run->signals[latch].name), PLAIN);
    note_coarse(run, answer, found);
    return found;
}

static void judge_bounded(struct run *run, const struct call *call, struct answer *answer)
{
    if (call->number[5] != 0.0 && answer->bound < 0.0) {
        found_nothing(run, answer, "the bound is negative, but a limit of speed is positive");
        return;
    }
    const struct judged judged = when_judged(run, call);
    const struct extreme found = worst_of(run, call, &judged, answer);
    const double sense = form_of(call, 0).sense, least = sense * answer->bound;
    const bool nowhere = !judged.always && judged.within.count == 0 && judged.gaps.count > 0;
    take_extreme(answer, found);
    answer->between = doubt_of(found); /* known only at the samples, the signal may be anything between them */
    answer->holds = nowhere || sense * found.sure >= least;
    answer->some_known = true;
    answer->gaps = judged.gaps;
    answer->unseen = call->number[2] == 0.0 ? short_run(run) : unpassed(run, window_of(call->number + 3));
    if (!(sense * found.possible >= least)) /* the bound lies within what the curve between the samples may be off */
        answer->off = larger(sense * found.value - sense * found.possible, least - sense * found.value);
}

/* ---- extremes that a component holds: the bound */

static void judge_held(struct run *run, const struct call *call, struct answer *answer)
{
    const int latch = signal_of(call, 0);
    answer->worst = last_of(run, latch);
    answer->time = reached(run, latch, signal_of(call, 1), (enum followed)call->number[1], run->samples - 1);
}

/* ---- a number that was found elsewhere: the bound, the number, its time, 1 if it may be anything */

static void judge_given(struct run *run, const struct call *call, struct answer *answer)
{
    (void)run;
    answer->worst = call->number[1];
    answer->time = call->number[2];
    if (call->number[3] != 0.0) {
        answer->holds = 1.0;
        answer->some_known = true;
    }
}
