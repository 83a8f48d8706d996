/* A recorded signal between its samples: on each interval the polynomial that it and its recorded rates give. */

static const double DOUBT = 0.25; /* of the difference between second rates over an interval, see `doubt` */

struct motion {
    struct run *run;
    ptrdiff_t samples, known;
    struct column columns[2 + MOST_RATES]; /* times, values, then their rates as far as they are known */
    const char *name;
    bool held;                               /* it goes one way between two samples, so these are its extremes */
    bool finite;                             /* all values and rates */
    double lowest, highest, longest, largest; /* samples; step from one to the next; magnitude */
    double *lows, *highs, *doubts;           /* of each interval, once they are needed */
};

static double sample(const struct motion *motion, ptrdiff_t column, ptrdiff_t place)
{
    return at_sample(motion->columns[column], place);
}

static double start_of(const struct motion *motion, ptrdiff_t interval)
{
    return sample(motion, 0, interval);
}

static double length_of(const struct motion *motion, ptrdiff_t interval)
{
    return sample(motion, 0, interval + 1) - sample(motion, 0, interval);
}

/* Points of the polynomial on an interval, and their number. */
static size_t piece(const struct motion *motion, ptrdiff_t interval, double *points)
{
    double h = length_of(motion, interval);
    double y0 = sample(motion, 1, interval), y1 = sample(motion, 1, interval + 1);
    points[0] = y0;
    if (motion->known == 1) {
        points[1] = y1;
        return 2;
    }
    double v0 = sample(motion, 2, interval) * h, v1 = sample(motion, 2, interval + 1) * h;
    if (motion->known == 2) {
        points[1] = y0 + v0 / 3.0;
        points[2] = y1 - v1 / 3.0;
        points[3] = y1;
        return 4;
    }
    double a0 = sample(motion, 3, interval) * (h * h), a1 = sample(motion, 3, interval + 1) * (h * h);
    points[1] = y0 + 0.2 * v0;
    points[2] = y0 + 0.4 * v0 + 0.05 * a0;
    points[3] = y1 - 0.4 * v1 + 0.05 * a1;
    points[4] = y1 - 0.2 * v1;
    points[5] = y1;
    return 6;
}

static void survey(struct motion *motion)
{
    double before = sample(motion, 1, 0);
    motion->finite = true;
    motion->lowest = motion->highest = before;
    motion->longest = 0.0;
    for (ptrdiff_t place = 0; place < motion->samples; place++) {
        double now = sample(motion, 1, place), step = fabs(now - before);
        for (ptrdiff_t column = 1; column <= motion->known; column++)
            motion->finite = motion->finite && isfinite(sample(motion, column, place));
        motion->lowest = now < motion->lowest || isnan(now) ? now : motion->lowest;
        motion->highest = now > motion->highest || isnan(now) ? now : motion->highest;
        motion->longest = step > motion->longest ? step : motion->longest;
        before = now;
    }
    motion->largest = larger(fabs(motion->lowest), fabs(motion->highest));
}

/* A signal between its samples, by so many of its rates at most. */
static struct motion *motion_of(struct run *run, int signal, int rates)
{
    struct motion **place = &run->signals[signal].motions[rates];
    if (*place != NULL)
        return *place;
    struct motion *made = take(run, &run->kept, sizeof *made);
    memset(made, 0, sizeof *made);
    made->run = run;
    made->samples = run->samples;
    made->columns[0] = run->time;
    for (int each = signal; each >= 0 && made->known <= rates; each = run->signals[each].rate)
        made->columns[++made->known] = run->signals[each].column;
    made->name = run->signals[signal].name;
    made->held = run->signals[signal].lowest == signal;
    survey(made);
    return *place = made;
}

static struct motion *curve(struct run *run, int signal)
{
    return motion_of(run, signal, MOST_RATES);
}

static struct motion *shaft_of(struct run *run)
{
    return run->shaft < 0 ? NULL : curve(run, run->shaft);
}

/* True if the values between the samples are known: by rates, or because samples are the extremes. */
static bool is_known(const struct motion *motion)
{
    return motion->known > 1 || motion->held;
}

/* Lowest and highest of the points of each interval; NaN where one of them is. */
static void find_reach(struct motion *motion)
{
    if (motion->lows != NULL)
        return;
    size_t size = (size_t)motion->samples * sizeof(double);
    motion->lows = take(motion->run, &motion->run->kept, 2 * size);
    motion->highs = motion->lows + motion->samples;
    for (ptrdiff_t interval = 0; interval + 1 < motion->samples; interval++) {
        double points[MOST], low, high;
        size_t count = piece(motion, interval, points);
        low = high = points[0];
        for (size_t place = 1; place < count && low == low; place++) {
            low = points[place] >= low ? low : points[place];
            high = points[place] <= high ? high : points[place];
        }
        motion->lows[interval] = low;
        motion->highs[interval] = low == low ? high : low;
    }
}

/* Whether the samples of some times are all as far apart. */
static bool is_even(struct column time, ptrdiff_t count)
{
    const double first = at_sample(time, 1) - at_sample(time, 0);
    for (ptrdiff_t place = 1; place + 1 < count; place++)
        if (at_sample(time, place + 1) - at_sample(time, place) != first)
            return false;
    return true;
}

/* The slope of three values or more at a sample, of second order, by those beside it. */
static double slope_at(struct column time, struct column values, ptrdiff_t count, ptrdiff_t place, bool even)
{
    const ptrdiff_t last = count - 1, middle = place < 1 ? 1 : place >= last ? last - 1 : place;
    const double f0 = at_sample(values, middle - 1), f1 = at_sample(values, middle), f2 = at_sample(values, middle + 1);
    double h = at_sample(time, 1) - at_sample(time, 0), a, b, c;
    if (even && place == middle)
        return (f2 - f0) / (2.0 * h);
    if (even) {
        a = (place == 0 ? -1.5 : 0.5) / h;
        b = (place == 0 ? 2.0 : -2.0) / h;
        c = (place == 0 ? -0.5 : 1.5) / h;
        return a * f0 + b * f1 + c * f2;
    }
    const double h0 = at_sample(time, middle) - at_sample(time, middle - 1);
    const double h1 = at_sample(time, middle + 1) - at_sample(time, middle);
    if (place == 0) {
        a = -(2.0 * h0 + h1) / (h0 * (h0 + h1));
        b = (h0 + h1) / (h0 * h1);
        c = -h0 / (h1 * (h0 + h1));
    } else if (place == last) {
        a = h1 / (h0 * (h0 + h1));
        b = -(h1 + h0) / (h0 * h1);
        c = (2.0 * h1 + h0) / (h1 * (h0 + h1));
    } else {
        a = -h1 / (h0 * (h0 + h1));
        b = (h1 - h0) / (h0 * h1);
        c = h0 / (h1 * (h0 + h1));
    }
    return a * f0 + b * f1 + c * f2;
}

/* Second rate at a sample: as recorded, or the slope of the rates beside it. */
static double bend(const struct motion *motion, ptrdiff_t place, bool even)
{
    if (motion->known > 2)
        return sample(motion, 3, place);
    if (motion->samples == 2)
        return (sample(motion, 2, 1) - sample(motion, 2, 0)) / length_of(motion, 0);
    return slope_at(motion->columns[0], motion->columns[2], motion->samples, place, even);
}

/* How far the polynomial on an interval may be off, at most in its middle.
 *
 * Values and rates give a cubic. Its second rates at the ends of an interval are compared with the recorded ones, or with
 * those that the rates of the neighbouring samples give. A quintic with these is away from the cubic by up to 1/29 of the
 * difference, a line with a corner in the interval by 1/4. On a smooth motion the cubic is off by 1/25 of that, the
 * quintic by far less. */
static double doubt(const struct motion *motion, ptrdiff_t interval, bool even)
{
    if (motion->known == 1)
        return motion->held ? 0.0 : INFINITY;
    double h = length_of(motion, interval), rise = sample(motion, 1, interval + 1) - sample(motion, 1, interval);
    double v0 = sample(motion, 2, interval) * h, v1 = sample(motion, 2, interval + 1) * h;
    double a0 = bend(motion, interval, even) * (h * h), a1 = bend(motion, interval + 1, even) * (h * h);
    double before = fabs(a0 - (6.0 * rise - 4.0 * v0 - 2.0 * v1));
    double after = fabs(a1 - (2.0 * v0 + 4.0 * v1 - 6.0 * rise));
    return DOUBT * (before > after ? before : after);
}

static void find_doubts(struct motion *motion)
{
    if (motion->doubts != NULL)
        return;
    const bool even = motion->samples > 1 && is_even(motion->columns[0], motion->samples);
    motion->doubts = take(motion->run, &motion->run->kept, (size_t)motion->samples * sizeof(double));
    for (ptrdiff_t interval = 0; interval + 1 < motion->samples; interval++)
        motion->doubts[interval] = doubt(motion, interval, even);
}

/* The interval that a time lies in. */
static ptrdiff_t interval_of(const struct motion *motion, double time)
{
    ptrdiff_t interval = samples_before(motion->run, time, true) - 1;
    interval = interval < motion->samples - 2 ? interval : motion->samples - 2;
    return interval > 0 ? interval : 0;
}

static double value_of(const struct motion *motion, double time)
{
    if (motion->samples == 1)
        return sample(motion, 1, 0);
    double points[MOST];
    ptrdiff_t interval = interval_of(motion, time);
    size_t count = piece(motion, interval, points);
    return value(points, count, (time - start_of(motion, interval)) / length_of(motion, interval));
}

/* Add the times at which a motion passes a level in an interval. */
static void add_passages(struct motion *motion, ptrdiff_t interval, double level, struct times *times)
{
    double points[MOST];
    size_t count = piece(motion, interval, points);
    ptrdiff_t known = times->count;
    for (size_t place = 0; place < count; place++)
        points[place] -= level;
    sign_changes(motion->run, points, count, 0.0, 1.0, times);
    for (ptrdiff_t place = known; place < times->count; place++)
        times->list[place] = start_of(motion, interval) + times->list[place] * length_of(motion, interval);
}

/* Times at which a motion passes a level, to rounding. */
static struct times crossings_of(struct motion *motion, double level)
{
    struct times times = {0, 0, NULL};
    find_reach(motion);
    for (ptrdiff_t interval = 0; interval + 1 < motion->samples; interval++)
        if (motion->lows[interval] - level < 0.0 && motion->highs[interval] - level >= 0.0)
            add_passages(motion, interval, level, &times);
    return times;
}

/* Stretches of time above a level, or with a negative sign below it; none if the motion is not finite. */
static struct stretches beyond(struct motion *motion, double level, double sign)
{
    struct stretches found = {0, 0, NULL};
    if (!motion->finite)
        return found;
    bool inside = (sample(motion, 1, 0) >= level) == (sign > 0.0), whole = false;
    double begin = start_of(motion, 0);
    struct times times = crossings_of(motion, level);
    for (ptrdiff_t place = 0; place < times.count; place++) {
        if (inside)
            add_stretch(motion->run, &found, begin, times.list[place], whole);
        inside = !inside;
        begin = times.list[place];
        whole = true;
    }
    if (inside)
        add_stretch(motion->run, &found, begin, sample(motion, 0, motion->samples - 1), false);
    return found;
}
