/* The grid of a system, and what is driven along tables, with dual numbers. */
#ifndef DUAL_GRID_H
#define DUAL_GRID_H

#include "dual.h"
#include "grid.h"

static inline dual dual_grid_place(dual time, dual step)
{
    return dual_made(grid_place(time.value, step.value), dual_quotient(time, step).tangent);
}

static inline dual dual_grid_between(const double *points, const double *values, int count, dual place)
{
    int last = grid_last(points, count, place.value);
    double slope = 0.0;
    if (last >= 0 && last < count - 1) {
        slope = (values[last + 1] - values[last]) / (points[last + 1] - points[last]);
    }
    return dual_made(grid_between(points, values, count, place.value), slope * place.tangent);
}

static inline dual dual_grid_held(const double *points, const double *values, int count, dual place)
{
    return dual_of(grid_held(points, values, count, place.value));
}

#endif
