/* Where a time stands on a grid of equal steps, and what is driven along tables: for systems of components. */
#ifndef GRID_H
#define GRID_H

#include <math.h>
#include <stdbool.h>

#define GRID_ROUNDING 1e-6 /* of a step: what sums of a host's steps may be off the grid */

/* A time in steps of that size from 0: a whole number where only rounding keeps it off the grid. */
static inline double grid_place(double time, double step)
{
    double steps = time / step, whole = floor(steps + 0.5);
    return fabs(steps - whole) <= GRID_ROUNDING ? whole : steps;
}

/* Steps from a time to each point of the grid on the way, and from there to an end; one step without a grid. */
typedef struct {
    double at, end, inner;
    double time, size; /* of the step that is to be made */
} Walk;

static inline Walk grid_walk(double time, double size, double inner)
{
    Walk walk = {0.0, 0.0, 0.0, time, size};
    if (inner > 0.0) {
        walk.at = grid_place(time, inner);
        walk.end = grid_place(time + size, inner);
        walk.inner = inner;
    }
    if (!(walk.at < walk.end)) { /* too short to tell both ends apart */
        walk.at = walk.inner = 0.0;
        walk.end = 1.0;
    }
    return walk;
}

/* Goes on to the next step; false at the end. */
static inline bool grid_next(Walk *walk)
{
    double at = walk->at, next = floor(at) + 1.0 < walk->end ? floor(at) + 1.0 : walk->end;
    if (at >= walk->end) {
        return false;
    }
    walk->at = next;
    if (walk->inner > 0.0) {
        bool whole = at >= floor(at) && at <= floor(at) && next >= at + 1.0;
        walk->time = at * walk->inner;
        walk->size = whole ? walk->inner : (next - at) * walk->inner;
    }
    return true;
}

/* The last of ascending points that is not after a place, or -1. */
static inline int grid_last(const double *points, int count, double place)
{
    int low = -1, high = count;
    while (high - low > 1) {
        int middle = low + (high - low) / 2;
        if (points[middle] <= place) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

/* The value at a place: on straight lines between the points, constant outside of them; as numpy's interp. */
static inline double grid_between(const double *points, const double *values, int count, double place)
{
    int last = grid_last(points, count, place);
    if (last < 0 || last == count - 1) {
        return values[last < 0 ? 0 : last];
    }
    return (values[last + 1] - values[last]) / (points[last + 1] - points[last]) * (place - points[last]) + values[last];
}

/* The value that was given last. */
static inline double grid_held(const double *points, const double *values, int count, double place)
{
    int last = grid_last(points, count, place);
    return values[last < 0 ? 0 : last];
}

#endif
