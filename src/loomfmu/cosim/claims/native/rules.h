/* All rules by their numbers, and what else is asked of them. */

typedef void judge_by(struct run *, const struct call *, struct answer *);
static const struct {
    const char *name;
    judge_by *judge;
} RULES[] = {
    {"bounded", judge_bounded},
    {"held", judge_held},
    {"margin", judge_margin},
    {"deflection", judge_deflection},
    {"contacts", judge_contacts},
    {"blows", judge_blows},
    {"power", judge_power},
    {"fluctuation", judge_fluctuation},
    {"energy", judge_energy},
    {"dwell", judge_dwell},
    {"clear_shed", judge_clear_shed},
    {"dwell_contains", judge_dwell_contains},
    {"shed", judge_shed},
    {"reed", judge_reed},
    {"transfer", judge_transfer},
    {"transfer_speed", judge_transfer_speed},
    {"nip", judge_nip},
    {"locks", judge_locks},
    {"given", judge_given},
};

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

/* What its curve may be off by between the samples, which runs on other steps may not show. */
static double unresolved(struct run *run, const struct call *call)
{
    if (!is_by(call, judge_bounded))
        return 0.0;
    struct answer unused = {0};
    const struct judged judged = when_judged(run, call);
    const struct extreme found = worst_of(run, call, &judged, &unused);
    const double sure = isfinite(found.sure) ? found.sure : found.value;
    return larger(fabs(found.value - found.possible), fabs(found.value - sure));
}

static void add_all(struct run *run, struct times *times, struct times others)
{
    for (ptrdiff_t place = 0; place < others.count; place++)
        add_time(run, times, others.list[place]);
}

/* Times at which a rule looks, as far as they are known before its extremes are. */
static struct times looks(struct run *run, const struct call *call)
{
    struct times times = {0, 0, NULL};
    const double *number = call->number;
    if (is_by(call, judge_bounded) && number[2] != 0.0) {
        add_all(run, &times, times_at(run, number[3]));
        add_all(run, &times, times_at(run, number[5]));
    } else if (is_by(call, judge_dwell) || is_by(call, judge_clear_shed)) {
        struct motion *lift = curve(run, signal_of(call, 0));
        const double distance = distance_of(call, is_by(call, judge_dwell));
        add_all(run, &times, crossings_of(lift, distance));
        add_all(run, &times, crossings_of(lift, number[1] - distance));
    } else if (is_by(call, judge_transfer)) {
        struct stretches within = times_within(run, window_of(number + 1));
        for (ptrdiff_t place = 0; place < within.count; place++)
            add_time(run, &times, within.list[place].start);
    } else if (is_by(call, judge_transfer_speed))
        times = crossings_of(curve(run, signal_of(call, 0)), number[1]);
    for (ptrdiff_t place = 2; is_by(call, judge_dwell_contains) && place < call->numbers; place++)
        add_all(run, &times, times_at(run, number[place]));
    return times;
}
