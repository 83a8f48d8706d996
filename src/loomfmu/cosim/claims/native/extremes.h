/* The lowest and highest values of signals between their samples, how sure they are, and what components hold of them. */

static const double COARSE = 0.2;   /* of a signal's range beyond its samples: fewer than four samples in an oscillation */
static const double ROUNDING = 1e-12; /* of the largest value: what rounding may add */
static const double ALIKE = 1e-8; /* of the largest value: held extremes that coarse steps alone tell apart; names places */

/* Lowest or highest value, its time, and whether the samples are too far apart to be sure of it.
 *
 * The motion certainly reaches `sure`, and nowhere goes beyond `possible`: the curve between the samples may be off by
 * `doubt`. A sample is sure. Of a motion that is known only at the samples, `possible` is infinite. */
struct extreme {
    double value, time, sure, possible;
    bool coarse;
};

static const struct extreme NO_EXTREME = {NAN, NAN, NAN, NAN, false};

/* What the value may be off by as the curve between the samples may be. */
static double doubt_of(struct extreme found)
{
    const double sure = isfinite(found.sure) ? found.sure : found.value;
    return larger(fabs(found.value - found.possible), fabs(found.value - sure));
}

/* The same where that is known: 0 for a motion that is known only at the samples. */
static double known_doubt(struct extreme found)
{
    const double doubt = doubt_of(found);
    return isfinite(doubt) ? doubt : 0.0;
}

static const double STEEPER = 2.0; /* how much more than in a step beside it a signal may change in one */

static double change_at(struct motion *motion, ptrdiff_t place)
{
    const bool inside = 0 <= place && place + 1 < motion->samples;
    return inside ? fabs(sample(motion, 1, place + 1) - sample(motion, 1, place)) : INFINITY;
}

/* The lowest value of `sign` times a motion as its samples tell, which go on for a step: a corner or a jump lies anywhere
 * between two of them. The step with the corner or the jump tells nothing of a slope, so the smaller change counts of the
 * steps at a sample, or of those behind them, twice over. The samples on both sides of an edge count where it divides a step. */
static double sampled_possible(struct motion *motion, double sign, const struct stretches *within)
{
    const struct run *run = motion->run;
    struct stretch all = {time_at(run, 0), end_of(run), true};
    double found = INFINITY;
    for (ptrdiff_t number = 0; number < (within == NULL ? 1 : within->count); number++) {
        const struct stretch *each = within == NULL ? &all : &within->list[number];
        const ptrdiff_t first = samples_before(run, each->start, true) - 1, end = samples_before(run, each->end, false);
        for (ptrdiff_t at = first < 0 ? 0 : first; at <= end && at < motion->samples; at++) {
            const double beside = smaller(change_at(motion, at - 1), change_at(motion, at));
            const double behind = smaller(change_at(motion, at - 2), change_at(motion, at + 1));
            const double slope = larger(isfinite(beside) ? beside : 0.0, isfinite(behind) ? behind : 0.0);
            found = smaller(found, sign * sample(motion, 1, at) - STEEPER * slope);
        }
    }
    return sign * found;
}

/* A search for where `sign` times a motion is lowest: values with their times, and the best, sure and possible ones. */
struct search {
    struct motion *motion;
    double sign, same, best, sure, possible;
    struct moments found;
};

static void add_value(struct search *search, double value, double time)
{
    add_moment(search->motion->run, &search->found, value, time);
}

static struct extreme reflected(struct extreme found, double sign)
{
    found.value *= sign;
    found.sure *= sign;
    found.possible *= sign;
    return found;
}

/* The lowest of some values, NaN if there is one or none, and the first time of those that are equal to it. */
static struct moment first_lowest(const struct moments *all, double same)
{
    struct moment found = {all->count > 0 ? INFINITY : NAN, NAN};
    for (ptrdiff_t place = 0; place < all->count && !isnan(found.value); place++) {
        const double value = all->list[place].value;
        if (!(value >= found.value) || (value == found.value && signbit(value))) /* -0 is lower than 0 */
            found.value = value;
    }
    for (ptrdiff_t place = 0; place < all->count; place++) {
        const struct moment *each = &all->list[place];
        if ((isnan(found.value) ? isnan(each->value) : each->value <= found.value + same) && !(each->time >= found.time))
            found.time = each->time;
    }
    return found;
}

/* Whether a time lies in one of some stretches, which are in order. */
static bool is_inside(const struct stretches *within, double time)
{
    ptrdiff_t low = 0, high = within->count;
    while (low < high) { /* the first that does not end before it */
        ptrdiff_t middle = low + (high - low) / 2;
        if (within->list[middle].end < time)
            low = middle + 1;
        else
            high = middle;
    }
    return low < within->count && within->list[low].start <= time;
}

/* The sample at which `sign` times the motion is lowest, NaN where there is none within. */
static struct extreme lowest_sample(struct motion *motion, double sign, const struct stretches *within)
{
    struct search search = {.motion = motion};
    for (ptrdiff_t place = 0; place < motion->samples; place++)
        if (within == NULL || is_inside(within, sample(motion, 0, place)))
            add_value(&search, sign * sample(motion, 1, place), sample(motion, 0, place));
    if (search.found.count == 0)
        return NO_EXTREME;
    const struct moment least = first_lowest(&search.found, SAME);
    struct extreme found = {least.value, least.time, least.value, -INFINITY, false};
    return reflected(found, sign);
}

/* Look for lower values on an interval, between two shares of the way. */
static void look_at(struct search *search, ptrdiff_t interval, double low, double high)
{
    struct motion *motion = search->motion;
    double points[MOST], curve[MOST], raised[MOST], share, doubt = motion->doubts[interval];
    size_t count = piece(motion, interval, curve);
    for (size_t place = 0; place < count; place++)
        points[place] = curve[place] = search->sign * curve[place];
    clip(points, count, low, high);
    search->best = smaller(search->best, smaller(points[0], points[count - 1]));
    if (!(least_point(points, count) <= larger(search->best + search->same, search->sure) + doubt))
        return;
    double least = lowest_of(motion->run, points, count, &share);
    share = share < 1.0 ? low + share * (high - low) : high;
    add_value(search, least, share < 1.0 ? start_of(motion, interval) + share * length_of(motion, interval)
                                         : start_of(motion, interval + 1));
    if (motion->known == 1) { /* part of an interval may reach either of its ends */
        search->possible = motion->held ? smaller(search->possible, smaller(curve[0], curve[1])) : -INFINITY;
        return;
    }
    for (int way = 1; way >= -1; way -= 2) {
        size_t raised_count = raise(curve, count, way * doubt, raised);
        clip(raised, raised_count, low, high);
        double *bound = way > 0 ? &search->sure : &search->possible;
        *bound = smaller(*bound, lowest_of(motion->run, raised, raised_count, &share));
    }
}

/* Look at each interval that may be as low as the lowest sample. */
static void look_everywhere(struct search *search)
{
    struct motion *motion = search->motion;
    find_reach(motion);
    search->best = search->sure = search->sign > 0.0 ? motion->lowest : -motion->highest;
    search->possible = search->best;
    add_value(search, search->sign * sample(motion, 1, 0), start_of(motion, 0));
    const double level = search->best + search->same;
    for (ptrdiff_t interval = 0; interval + 1 < motion->samples; interval++)
        if ((search->sign > 0.0 ? motion->lows[interval] : -motion->highs[interval]) <= level + motion->doubts[interval])
            look_at(search, interval, 0.0, 1.0);
}

/* Look at the part of each interval that lies within some stretches of time, which are in order. */
static void look_within(struct search *search, const struct stretches *within)
{
    struct motion *motion = search->motion;
    struct times cuts = {0, 0, NULL};
    search->best = search->sure = INFINITY;
    for (ptrdiff_t place = 0; place < 2 * within->count; place++) {
        const struct stretch *each = &within->list[place / 2];
        double edge = place % 2 == 0 ? each->start : each->end, there = search->sign * value_of(motion, edge);
        add_value(search, there, edge);
        add_time(motion->run, &cuts, edge);
        search->best = smaller(search->best, there);
    }
    for (ptrdiff_t place = 0; place < motion->samples; place++) {
        double time = sample(motion, 0, place), there = search->sign * sample(motion, 1, place);
        add_time(motion->run, &cuts, time);
        if (is_inside(within, time))
            search->sure = smaller(search->sure, there);
    }
    search->possible = search->best;
    order_times(&cuts);
    for (ptrdiff_t place = 0; place + 1 < cuts.count; place++) {
        double start = cuts.list[place], end = cuts.list[place + 1];
        if (motion->samples > 1 && is_inside(within, 0.5 * (end + start))) {
            ptrdiff_t interval = interval_of(motion, start);
            double begun = start_of(motion, interval), h = length_of(motion, interval);
            look_at(search, interval, (start - begun) / h, (end - begun) / h);
        }
    }
}

/* Where `sign` times the motion is lowest, in the whole run or in some stretches of time. */
static struct extreme lowest(struct motion *motion, double sign, const struct stretches *within)
{
    if (!motion->finite)
        return lowest_sample(motion, sign, within);
    struct search search = {.motion = motion, .sign = sign, .same = SAME * motion->largest};
    if (within == NULL && motion->known == 1) { /* straight lines are lowest at a sample */
        struct extreme found = lowest_sample(motion, sign, NULL);
        search.sure = sign * found.value;
        search.possible = motion->held ? search.sure : -INFINITY;
        for (ptrdiff_t place = motion->samples - 1; place >= 0; place--)
            if (sign * sample(motion, 1, place) <= search.sure + search.same)
                found.time = sample(motion, 0, place);
        add_value(&search, search.sure, found.time);
    } else {
        find_doubts(motion);
        if (within == NULL)
            look_everywhere(&search);
        else
            look_within(&search, within);
    }
    if (search.found.count == 0)
        return NO_EXTREME;
    const struct moment least = first_lowest(&search.found, search.same);
    const double rounding = ROUNDING * motion->largest, highest = sign > 0.0 ? motion->highest : -motion->lowest;
    const ptrdiff_t before = interval_of(motion, least.time), after = motion->samples == 1 ? 0 : before + 1;
    const double off = smaller(sign * sample(motion, 1, before), sign * sample(motion, 1, after)) - least.value;
    struct extreme found = {least.value, least.time, search.sure + rounding, smaller(search.possible, least.value) + rounding,
                            off > larger(COARSE * (highest - least.value), SAME * motion->largest)};
    return reflected(found, sign);
}

/* How near the motion comes to a level in some stretches of time: 0 where it passes it. */
static struct extreme nearest(struct motion *motion, double level, const struct stretches *within)
{
    if (!motion->finite)
        return NO_EXTREME;
    struct extreme found = {.value = 0.0};
    double doubt = 0.0;
    struct times passed = crossings_of(motion, level);
    struct moments sides = {0, 0, NULL};
    for (ptrdiff_t place = 0; place < passed.count; place++)
        if (is_inside(within, passed.list[place])) {
            found.time = passed.list[place];
            return found;
        }
    for (int sign = 1; sign >= -1; sign -= 2) {
        struct stretches side = {0, 0, NULL};
        for (ptrdiff_t place = 0; place < within->count; place++) {
            struct stretch each = within->list[place];
            if ((value_of(motion, 0.5 * (each.start + each.end)) >= level) == (sign > 0))
                add_stretch(motion->run, &side, each.start, each.end, each.whole);
        }
        if (side.count > 0) {
            struct extreme its = lowest(motion, sign, &side);
            add_moment(motion->run, &sides, sign * (its.value - level), its.time);
            found.coarse = found.coarse || its.coarse;
            doubt = larger(doubt, known_doubt(its));
        }
    }
    const struct moment least = first_lowest(&sides, SAME);
    found.value = found.sure = least.value;
    found.time = least.time;
    found.possible = least.value - doubt;
    return found;
}

/* ---- extremes that a component finds on its continuous curve, and holds */

enum followed { AS_IT_IS, NEGATIVE, MAGNITUDE }; /* how a signal's extreme is its lowest value */

static double as_followed(double value, enum followed followed)
{
    return followed == AS_IT_IS ? value : followed == NEGATIVE ? -value : -fabs(value);
}

/* When the extreme that is held at a sample was reached, as well as the samples show it.
 *
 * The latch gives the step. Within it, the time is the vertex of the parabola through the lowest samples of what the latch
 * follows. */
static double reached(const struct run *run, int latch, int signal, enum followed followed, ptrdiff_t held_at)
{
    const ptrdiff_t last = run->samples - 1;
    double scale = 0.0, held = sample_of(run, latch, held_at), y[3], t[3];
    ptrdiff_t step = 0;
    for (ptrdiff_t place = 0; place <= last; place++)
        scale = larger(scale, fabs(sample_of(run, signal, place)));
    while (step < held_at && !(fabs(sample_of(run, latch, step) - held) <= ALIKE * scale))
        step++;
    if (step == 0 || isnan(held))
        return time_at(run, 0);
    while (step < held_at && as_followed(sample_of(run, signal, step + 1), followed)
                                 < as_followed(sample_of(run, signal, step), followed))
        step++; /* fine steps come close to the extreme before they reach it */
    double there = as_followed(sample_of(run, signal, step), followed);
    ptrdiff_t least = there <= as_followed(sample_of(run, signal, step - 1), followed) ? step : step - 1;
    if (!(0 < least && least < last))
        return time_at(run, least);
    for (ptrdiff_t place = 0; place < 3; place++) {
        t[place] = time_at(run, least - 1 + place);
        y[place] = as_followed(sample_of(run, signal, least - 1 + place), followed);
    }
    double before = (y[1] - y[0]) / (t[1] - t[0]), after = (y[2] - y[1]) / (t[2] - t[1]);
    if (after <= before)
        return t[1];
    double turn = 0.5 * (t[0] + t[1]) - 0.5 * before * (t[2] - t[0]) / (after - before);
    double begin = time_at(run, step - 1), end = time_at(run, step);
    return smaller(larger(turn, begin), end);
}

/* The lowest value of `sign` times a signal, as its component holds it, or as `found`. Returns the latch if it counts.
 *
 * The held value changes where the signal is more extreme than ever before, and nowhere is the signal more extreme than
 * that. */
static int latched(struct run *run, int signal, double sign, struct extreme *found, const struct stretches *within)
{
    const int latch = sign > 0.0 ? run->signals[signal].lowest : run->signals[signal].highest;
    const ptrdiff_t end = run->samples - 1;
    const double near = SAME * (end_of(run) - time_at(run, 0));
    struct stretch all = {time_at(run, 0), end_of(run), false};
    const struct stretch *stretches = within == NULL ? &all : within->list;
    double possible = INFINITY, best = INFINITY;
    ptrdiff_t best_last = -1;
    bool some = false;
    for (ptrdiff_t place = 0; place < (within == NULL ? 1 : within->count); place++) {
        const struct stretch *each = &stretches[place];
        if (!(each->start < each->end) && within != NULL)
            continue;
        ptrdiff_t first = samples_before(run, each->start - near, false);
        ptrdiff_t last = samples_before(run, each->end + near, true) - 1;
        ptrdiff_t after = samples_before(run, each->end - near, false);
        double inside = sign * sample_of(run, latch, last < 0 ? 0 : last);
        double later = sign * sample_of(run, latch, after < end ? after : end);
        possible = !some || later < possible ? later : possible;
        some = true;
        if (inside < sign * sample_of(run, latch, first < end ? first : end) && (best_last < 0 || inside < best)) {
            best = inside;
            best_last = last;
        }
    }
    if (some)
        found->possible = sign * possible;
    if (best_last < 0 || best > sign * found->value)
        return -1;
    found->value = found->sure = sign * best;
    found->time = reached(run, latch, signal, sign > 0.0 ? AS_IT_IS : NEGATIVE, best_last);
    found->coarse = false;
    return latch;
}
