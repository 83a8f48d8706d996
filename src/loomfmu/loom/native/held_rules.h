/* Rules of claims on extremes that components of the loom hold: the bound. */

static void judge_margin(struct run *run, const struct call *call, struct answer *answer)
{
    judge_held(run, call, answer);
    note(run, answer, answer->worst >= 1.0 ? "the belt is never at risk in this run" : "", PLAIN);
}

static void judge_deflection(struct run *run, const struct call *call, struct answer *answer)
{
    const double pushed = last_of(run, signal_of(call, 2));
    judge_held(run, call, answer);
    note(run, answer, text(run, "while the head was pushed: %.2g mm", pushed / 0.001), PLAIN); /* its error is 1 % */
    note(run, answer, last_of(run, signal_of(call, 3)) != 0.0 ? "the belt folded" : "", PLAIN);
    if (last_of(run, signal_of(call, 4)) != 0.0)
        note(run, answer, "free lengths above 5 times bow_length do not count", PLAIN);
}

/* The first sample that has the final value of a signal. */
static double first_final(const struct run *run, int signal)
{
    ptrdiff_t place = 0;
    while (place < run->samples - 1 && sample_of(run, signal, place) != last_of(run, signal))
        place++;
    return time_at(run, isnan(last_of(run, signal)) ? 0 : place);
}

static void judge_contacts(struct run *run, const struct call *call, struct answer *answer)
{
    answer->worst = last_of(run, signal_of(call, 0));
    answer->time = answer->worst > 0.0 ? first_final(run, signal_of(call, 0)) : NAN;
}

static void judge_blows(struct run *run, const struct call *call, struct answer *answer)
{
    const double blows = last_of(run, signal_of(call, 1));
    answer->worst = last_of(run, signal_of(call, 0));
    answer->time = blows != 0.0 ? first_final(run, signal_of(call, 0)) : NAN;
    note(run, answer, text(run, "%.0f blow%s", blows, blows == 1.0 ? "" : "s"), PLAIN);
}
