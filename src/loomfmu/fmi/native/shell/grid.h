/* Where a time stands on a grid of equal steps, and what is driven along tables: for systems of components. */
#ifndef GRID_H
#define GRID_H

#include <math.h>

#define GRID_ROUNDING 1e-6 /* of a step: what sums of a host's steps may be off the grid */

/* A time in steps of that size from 0: a whole number where only rounding keeps it off the grid. */
static inline double grid_place(double time, double step)
{
    double steps = time / step, whole = floor(steps + 0.5);
    return fabs(steps - whole) <= GRID_ROUNDING ? whole : steps;
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
