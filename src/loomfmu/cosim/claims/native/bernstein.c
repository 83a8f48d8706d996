/* A recorded signal between its samples: as curves.py and bernstein.py find it, in the same operations. */

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

enum { MOST = 6 };                       /* points: those of a quintic */
static const double NARROWEST = 0x1p-60; /* halved more often than doubles can tell apart */

struct motion { /* compiled.py has the same struct */
    ptrdiff_t samples, known;
    struct {
        const char *first;
        ptrdiff_t stride; /* bytes from one sample to the next */
    } columns[4];         /* times, values, then their rates as far as they are known */
};

struct found {
    const struct motion *motion;
    ptrdiff_t interval, room, count;
    double *times;
};

static double sample(const struct motion *motion, ptrdiff_t column, ptrdiff_t place)
{
    return *(const double *)(motion->columns[column].first + place * motion->columns[column].stride);
}

/* Points of the polynomial on an interval, and their number. */
static size_t piece(const struct motion *motion, ptrdiff_t interval, double *points)
{
    double h = sample(motion, 0, interval + 1) - sample(motion, 0, interval);
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

/* Value at a share of the way, by de Casteljau's scheme. */
static double value(const double *points, size_t count, double share)
{
    double row[MOST];
    for (size_t place = 0; place < count; place++)
        row[place] = points[place];
    for (size_t left = count - 1; left > 0; left--)
        for (size_t place = 0; place < left; place++)
            row[place] = row[place] + share * (row[place + 1] - row[place]);
    return row[0];
}

/* Where a polynomial that changes its sign once does so: halved until nothing is left between. */
static double sign_change(const double *points, size_t count)
{
    const bool begins_negative = points[0] < 0.0;
    double low = 0.0, high = 1.0, middle = 0.5;
    while (low < middle && middle < high) {
        if ((value(points, count, middle) < 0.0) == begins_negative)
            low = middle;
        else
            high = middle;
        middle = 0.5 * (low + high);
    }
    return high;
}

static void add(struct found *found, double share)
{
    double start = sample(found->motion, 0, found->interval);
    if (found->count < found->room)
        found->times[found->count] = start + share * (sample(found->motion, 0, found->interval + 1) - start);
    found->count++;
}

/* Times at which one piece changes its sign, in order; 0 counts as positive. */
static void sign_changes(const double *points, size_t count, double begin, double width, struct found *found)
{
    int changes = 0;
    for (size_t place = 1; place < count; place++)
        changes += (points[place - 1] < 0.0) != (points[place] < 0.0);
    if (changes == 1)
        add(found, begin + width * sign_change(points, count));
    if (changes <= 1)
        return;
    if (width < NARROWEST) {
        if ((points[0] < 0.0) != (points[count - 1] < 0.0))
            add(found, begin);
        return;
    }
    double left[MOST], row[MOST];
    for (size_t place = 0; place < count; place++)
        row[place] = points[place];
    for (size_t order = 0; order < count; order++) { /* the right half stays in the row */
        left[order] = row[0];
        for (size_t place = 0; place + order + 1 < count; place++)
            row[place] = row[place] + 0.5 * (row[place + 1] - row[place]);
    }
    sign_changes(left, count, begin, 0.5 * width, found);
    sign_changes(row, count, begin + 0.5 * width, 0.5 * width, found);
}

/* The value at a time within a run of two samples or more. */
EXPORT double value_at(const struct motion *motion, double time)
{
    ptrdiff_t low = 0, high = motion->samples;
    while (low < high) { /* the first sample after the time */
        ptrdiff_t middle = low + (high - low) / 2;
        if (time < sample(motion, 0, middle))
            high = middle;
        else
            low = middle + 1;
    }
    ptrdiff_t interval = low - 1 < motion->samples - 2 ? low - 1 : motion->samples - 2;
    interval = interval > 0 ? interval : 0;
    double points[MOST], before = sample(motion, 0, interval), after = sample(motion, 0, interval + 1);
    size_t count = piece(motion, interval, points);
    return value(points, count, (time - before) / (after - before));
}

/* Lowest and highest of the points of each interval; NaN where one of them is. */
EXPORT void reach(const struct motion *motion, double *lowest, double *highest)
{
    for (ptrdiff_t interval = 0; interval + 1 < motion->samples; interval++) {
        double points[MOST], low, high;
        size_t count = piece(motion, interval, points);
        low = high = points[0];
        for (size_t place = 1; place < count && low == low; place++) {
            low = points[place] >= low ? low : points[place];
            high = points[place] <= high ? high : points[place];
        }
        lowest[interval] = low;
        highest[interval] = low == low ? high : low;
    }
}

/* How often the motion passes a level; as many of the times as there is room for. */
EXPORT ptrdiff_t crossings(
    const struct motion *motion, const double *lowest, const double *highest, double level, double *times,
    ptrdiff_t room)
{
    struct found found = {motion, 0, room, 0, times};
    for (; found.interval + 1 < motion->samples; found.interval++) {
        if (!(lowest[found.interval] - level < 0.0 && highest[found.interval] - level >= 0.0))
            continue;
        double points[MOST];
        size_t count = piece(motion, found.interval, points);
        for (size_t place = 0; place < count; place++)
            points[place] -= level;
        sign_changes(points, count, 0.0, 1.0, &found);
    }
    return found.count;
}

static double whole(double turns)
{
    double cut = (double)(long long)turns;
    return cut > turns ? cut - 1.0 : cut;
}

/* The same for all levels that are whole turns from one; to rounding a sample itself may be such a level. */
EXPORT ptrdiff_t passes(const struct motion *motion, double level, double turn, double *times, ptrdiff_t room)
{
    struct found found = {motion, 0, room, 0, times};
    for (; found.interval + 1 < motion->samples; found.interval++) {
        double before = sample(motion, 1, found.interval), after = sample(motion, 1, found.interval + 1);
        if (!isfinite(before) || !isfinite(after))
            continue;
        double low = whole((before - level) / turn), high = whole((after - level) / turn);
        if (low > high) {
            double swapped = low;
            low = high;
            high = swapped;
        }
        for (double turns = low + 1.0; turns <= high; turns++) {
            double points[MOST], there = level + turn * turns;
            size_t count = piece(motion, found.interval, points);
            ptrdiff_t known = found.count;
            for (size_t place = 0; place < count; place++)
                points[place] -= there;
            sign_changes(points, count, 0.0, 1.0, &found);
            if (found.count == known)
                add(&found, fabs(after - there) < fabs(before - there) ? 1.0 : 0.0);
        }
    }
    return found.count;
}

/* Whether all values and rates are finite; lowest and highest value, longest step. */
EXPORT void survey(const struct motion *motion, double *facts)
{
    bool finite = true;
    double before = sample(motion, 1, 0), lowest = before, highest = before, longest = 0.0;
    for (ptrdiff_t place = 0; place < motion->samples; place++) {
        double now = sample(motion, 1, place), step = fabs(now - before);
        for (ptrdiff_t column = 1; column <= motion->known; column++)
            finite = finite && isfinite(sample(motion, column, place));
        lowest = now < lowest || isnan(now) ? now : lowest;
        highest = now > highest || isnan(now) ? now : highest;
        longest = step > longest ? step : longest;
        before = now;
    }
    facts[0] = finite;
    facts[1] = lowest;
    facts[2] = highest;
    facts[3] = longest;
}
