/* Where the main shaft stands in a run, and when it passes an angle; where a signal is not known. */

/* Between samples farther apart a window of risk may be lost whole. With 20 samples in a revolution the lowest margin of
 * the published looms is known to 2e-3, with 16 to 5e-3, and with 8 not at all. */
static const double FARTHEST = 6.283185307179586 / 20.0;
static const double BACK = 1e-6; /* of its range, or of a turn: an angle that close to another one is back there */
static const double STANDS = 1e-9; /* of a revolution: angles that are closer are one where a run begins or ends */
static const char UNPASSED[] = "the run never passes through the whole window";

struct window { /* of the shaft's angle in its revolution: where it begins, and how far it reaches */
    double start, width;
};

struct place {
    double angle, revolution; /* counted from 1 the way that the shaft turns */
};

static bool too_coarse(const struct motion *turning)
{
    return turning->longest > FARTHEST * (1.0 + SAME);
}

enum { WORDS = 8, PICKS_IN_A_WORD = 16 }; /* of a frame's pattern: its length, then words whose bits are its pegs */

static int peg(const double *pattern, int pick)
{
    return (int)pattern[1 + pick / PICKS_IN_A_WORD] >> pick % PICKS_IN_A_WORD & 1;
}

/* The picks after which a frame's pattern repeats. */
static int repeat_of(const double *pattern)
{
    const int length = pattern[0] >= 1.0 && pattern[0] <= WORDS * PICKS_IN_A_WORD ? (int)pattern[0] : 1;
    int repeat = 1, same = 0;
    while (same < length) { /* picks that are the same so much later */
        if (peg(pattern, same) == peg(pattern, (same + repeat) % length))
            same++;
        else {
            repeat++;
            same = 0;
        }
    }
    return repeat;
}

static struct place place_at(struct run *run, double time)
{
    struct motion *turning = shaft_of(run);
    double at = value_of(turning, time), first = sample(turning, 1, 0);
    double way = sample(turning, 1, run->samples - 1) < first ? -1.0 : 1.0;
    struct place place = {at - TURN * floor(at / TURN), floor(way * at / TURN) - floor(way * first / TURN) + 1.0};
    return place;
}

/* Times at which the shaft passes an angle or one that is whole turns from it; to rounding a sample itself may be such. */
static struct times passes_of(struct motion *motion, double level)
{
    struct times times = {0, 0, NULL};
    for (ptrdiff_t interval = 0; interval + 1 < motion->samples; interval++) {
        double before = sample(motion, 1, interval), after = sample(motion, 1, interval + 1);
        if (!isfinite(before) || !isfinite(after))
            continue;
        double one = floor((before - level) / TURN), other = floor((after - level) / TURN);
        double low = one < other ? one : other, high = one < other ? other : one;
        for (double turns = low + 1.0; turns <= high; turns++) {
            const double there = level + TURN * turns;
            const ptrdiff_t known = times.count;
            add_passages(motion, interval, there, &times);
            if (times.count == known) {
                double share = fabs(after - there) < fabs(before - there) ? 1.0 : 0.0;
                add_time(motion->run, &times, start_of(motion, interval) + share * length_of(motion, interval));
            }
        }
    }
    return times;
}

/* All times at which the shaft stands at an angle of its revolution, each once.
 *
 * Where the run begins or ends there, to rounding, the shaft may pass the angle as well: that is one time. */
static struct times times_at(struct run *run, double wanted)
{
    struct motion *turning = shaft_of(run);
    struct times times = passes_of(turning, wanted);
    for (int end = 0; end < 2; end++) {
        const ptrdiff_t place = end == 0 ? 0 : run->samples - 1;
        const double angle = sample(turning, 1, place), time = time_at(run, place), turned = (angle - wanted) / TURN;
        if (!(fabs(turned - nearbyint(turned)) < STANDS))
            continue;
        ptrdiff_t kept = 0;
        for (ptrdiff_t each = 0; each < times.count; each++) {
            double away = fabs(value_of(turning, times.list[each]) - angle);
            double between = fabs(value_of(turning, 0.5 * (times.list[each] + time)) - angle);
            if (larger(away, between) > 2.0 * STANDS * TURN)
                times.list[kept++] = times.list[each];
        }
        times.count = kept;
        add_time(run, &times, time);
    }
    order_times(&times);
    return times;
}

/* Times at which the run begins and each of its revolutions ends, once each however the shaft turns back. */
static struct times revolutions(struct run *run)
{
    struct motion *turning = shaft_of(run);
    const double first = sample(turning, 1, 0), way = sample(turning, 1, run->samples - 1) < first ? -1.0 : 1.0;
    struct times times = times_at(run, first);
    ptrdiff_t kept = 0;
    for (ptrdiff_t each = 0; each < times.count; each++)
        if (nearbyint(way * (value_of(turning, times.list[each]) - first) / TURN) == (double)kept)
            times.list[kept++] = times.list[each];
    times.count = kept;
    return times;
}

/* Whether an angle stands, or is back where it was after a revolution of the main shaft. */
static bool swings(struct run *run, struct motion *motion)
{
    const double range = motion->highest - motion->lowest;
    if (range == 0.0 || run->shaft < 0)
        return range == 0.0;
    struct times turns = revolutions(run);
    return turns.count > 1 && fabs(value_of(motion, turns.list[1]) - value_of(motion, turns.list[0])) <= BACK * range;
}

/* A note if a shaft turns by less than so many revolutions; empty otherwise. */
static const char *turned_less(struct run *run, struct mover shaft, double wanted, const char *why)
{
    double turned = fabs(shaft.speed) * (end_of(run) - time_at(run, 0)) / TURN;
    const char *which = "a mechanism at its own speed";
    if (shaft.angle >= 0.0) {
        struct motion *turning = curve(run, (int)shaft.angle);
        turned = (turning->highest - turning->lowest) / shaft.turn;
        if (shaft.turns == 0.0 && swings(run, turning))
            return "";
        which = shaft.angle == run->shaft ? "the shaft" : run->signals[(int)shaft.angle].name;
    } else if (shaft.speed == 0.0) /* it stands */
        return "";
    if (turned >= wanted - STANDS)
        return "";
    const char *number = text(run, "%.4g", fabs(turned)); /* without the sign that a NaN may have */
    return text(run, "%s turns by only %s revolution%s, %s", which, number, strcmp(number, "1") == 0 ? "" : "s", why);
}

/* A note on a run of less than so many revolutions of what turns that which the question is about, the main shaft included
 * or not; empty for others.
 *
 * Where nothing is known to turn it, the main shaft matters. */
static const char *turns_less(struct run *run, bool main, double wanted, const char *why)
{
    const struct mover shaft = {run->shaft, 1.0, TURN, 0.0};
    const char *note = run->moving == 0 && run->shaft >= 0 && main ? turned_less(run, shaft, wanted, why) : "";
    for (const struct mover *each = run->movers; each < run->movers + run->moving && *note == '\0'; each++)
        if (main || each->angle < 0.0 || each->angle != run->shaft)
            note = turned_less(run, *each, wanted, why);
    return note;
}

static const char WHOLE[] = "and the claim takes a whole one";

/* A note on a run in which something that matters turns by less than a revolution; empty for others. */
static const char *short_run(struct run *run)
{
    return turns_less(run, true, 1.0, WHOLE);
}

/* The same where the run shows all that the question asks of the main shaft. */
static const char *short_but_for_shaft(struct run *run)
{
    return turns_less(run, false, 1.0, WHOLE);
}

/* A note on a run that is shorter than the repeat of the weave; empty for others. */
static const char *unwoven(struct run *run, const double *pegs, ptrdiff_t count)
{
    double picks = 1.0;
    for (const double *pattern = pegs; pattern < pegs + count; pattern += 1 + WORDS) {
        const double repeat = repeat_of(pattern);
        double common = repeat, rest = picks; /* their greatest divisor, by Euclid */
        while (rest != 0.0) {
            const double next = fmod(common, rest);
            common = rest;
            rest = next;
        }
        picks *= repeat / common;
    }
    if (picks == 1.0) /* as `short_run` says */
        return "";
    return turns_less(run, true, picks, text(run, "and the weave repeats after %.0f; set revolutions = %.0f or more", picks, picks));
}

/* Stretches of time in which the shaft is in a window of its revolution, the edges included as stretches without length. */
static struct stretches times_within(struct run *run, struct window window)
{
    struct motion *turning = shaft_of(run);
    struct times edges = times_at(run, window.start), marks = {0, 0, NULL};
    struct stretches found = {0, 0, NULL};
    if (window.width < TURN) {
        struct times ends = times_at(run, window.start + window.width);
        for (ptrdiff_t place = 0; place < ends.count; place++)
            add_time(run, &edges, ends.list[place]);
        order_times(&edges);
    }
    add_time(run, &marks, time_at(run, 0));
    for (ptrdiff_t place = 0; place < edges.count; place++) {
        add_time(run, &marks, edges.list[place]);
        add_stretch(run, &found, edges.list[place], edges.list[place], true);
    }
    add_time(run, &marks, end_of(run));
    order_times(&marks);
    for (ptrdiff_t place = 0; place + 1 < marks.count; place++) {
        double middle = value_of(turning, 0.5 * (marks.list[place + 1] + marks.list[place]));
        if (remainder_of(middle - window.start, TURN) <= window.width)
            add_stretch(run, &found, marks.list[place], marks.list[place + 1], true);
    }
    order_stretches(&found);
    return found;
}

/* The passes of the shaft through a window, without those that the run cuts off. */
static struct stretches passes(struct run *run, struct window window)
{
    struct stretches within = times_within(run, window), found = {0, 0, NULL};
    for (ptrdiff_t place = 0; place < within.count; place++) {
        struct stretch each = within.list[place];
        bool begins = false, ends = false;
        for (ptrdiff_t other = 0; other < within.count; other++)
            if (within.list[other].start == within.list[other].end) {
                begins = begins || within.list[other].start == each.start;
                ends = ends || within.list[other].start == each.end;
            }
        const double turned = fabs(value_of(shaft_of(run), each.end) - value_of(shaft_of(run), each.start));
        /* a shaft that turns back may leave by the edge by which it has come */
        if (each.start < each.end && begins && ends && turned > 0.5 * window.width)
            add_stretch(run, &found, each.start, each.end, true);
    }
    return found;
}

/* Whether the shaft turns back anywhere in the run. */
static bool turns_back(struct run *run)
{
    if (run->shaft < 0)
        return false;
    struct motion *turning = shaft_of(run);
    const double way = sample(turning, 1, run->samples - 1) < sample(turning, 1, 0) ? -1.0 : 1.0;
    double farthest = -INFINITY;
    for (ptrdiff_t place = 0; place < run->samples; place++) {
        const double angle = way * sample(turning, 1, place);
        if (angle < farthest - BACK * TURN)
            return true;
        farthest = larger(farthest, angle);
    }
    return false;
}

/* A note on a run that shows a window of the revolution only in part; empty for others. */
static const char *unpassed(struct run *run, struct window window)
{
    const struct mover shaft = {run->shaft, 1.0, TURN, 0.0};
    if (*turned_less(run, shaft, 1.0, WHOLE) != '\0' && passes(run, window).count == 0)
        return UNPASSED;
    return short_but_for_shaft(run);
}

/* ---- where a signal is not known, and how far it may be off, as signals beside it say */

/* Stretches of time in which a signal is not known, from the last sample at which it is to the next one.
 *
 * They are endless where there is no such sample. Of some stretches `within` they are those that overlap these. */
static struct stretches gaps(struct run *run, int signal, const struct stretches *within)
{
    struct stretches found = {0, 0, NULL};
    const int flag = signal < 0 ? -1 : run->signals[signal].valid_if;
    double start = -INFINITY;
    bool open = false;
    for (ptrdiff_t place = 0; flag >= 0 && place <= run->samples; place++) {
        const bool known = place == run->samples || sample_of(run, flag, place) != 0.0;
        const double time = place == run->samples ? INFINITY : time_at(run, place);
        bool counts = within == NULL;
        for (ptrdiff_t each = 0; open && known && !counts && each < within->count; each++)
            counts = start < within->list[each].end && within->list[each].start < time;
        if (open && known && counts)
            add_stretch(run, &found, start, time, true);
        open = !known;
        if (known)
            start = time;
    }
    return found;
}

/* What is left of some stretches of time, or of the whole run, without others. */
static struct stretches without(struct run *run, const struct stretches *gaps, const struct stretches *within)
{
    struct stretches left = {0, 0, NULL};
    if (within == NULL)
        add_stretch(run, &left, time_at(run, 0), end_of(run), true);
    else
        left = *within;
    for (ptrdiff_t gap = 0; gap < gaps->count; gap++) {
        struct stretches pieces = {0, 0, NULL};
        for (ptrdiff_t place = 0; place < left.count; place++) {
            struct stretch each = left.list[place];
            double end = smaller(each.end, gaps->list[gap].start), start = larger(each.start, gaps->list[gap].end);
            if (each.start <= end)
                add_stretch(run, &pieces, each.start, end, each.whole);
            if (start <= each.end)
                add_stretch(run, &pieces, start, each.end, each.whole);
        }
        left = pieces;
    }
    return left;
}

/* A note that a signal is not known, from when on, and who says so. */
static const char *unknown_note(struct run *run, int signal, double start)
{
    const struct signal *flag = &run->signals[run->signals[signal].valid_if];
    double since = larger(start, time_at(run, 0));
    const char *at = text(run, "%.6g s", since);
    if (run->shaft >= 0) {
        struct place place = place_at(run, since);
        at = text(run, "%s, %s, rev. %.0f", at, degrees(run, place.angle), place.revolution);
    }
    return text(run, "not known from %s on, as %s is false (\"%s\")", at, flag->name, flag->about);
}

/* How far a signal may be off whatever the steps: wherever it is as near to the worst value as it may be off. */
static double off_by(struct run *run, int signal, double worst, double time, const struct stretches *within)
{
    const int error = run->signals[signal].error;
    ptrdiff_t here = samples_before(run, time, false);
    double most = 0.0;
    here = here < run->samples - 1 ? here : run->samples - 1;
    for (ptrdiff_t place = 0; error >= 0 && place < run->samples; place++) {
        double off = fabs(sample_of(run, error, place));
        bool near = place == here || place == (here > 0 ? here - 1 : 0);
        near = near || (fabs(sample_of(run, signal, place) - worst) <= off
                        && (within == NULL || is_inside(within, time_at(run, place))));
        if (near && !(off <= most))
            most = off;
    }
    return most;
}
