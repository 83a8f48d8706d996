/* Broyden's method for values that are to be what comes out of them, as those on the wires of a loop.
 *
 * What it has learnt of the slopes is kept from one step to the next, and a step begins with values that go on
 * as over the last ones. `Broyden` in Python does the same arithmetic, to the last bit.
 */
#ifndef BROYDEN_H
#define BROYDEN_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

struct rule { /* loops.py describes its numbers */
    int64_t most_exchanges, few, stalls, orders;
    double tolerance, small, rounding, flat;
};

struct solver {
    size_t count;
    double *largest;     /* magnitude of each value so far */
    double *differences; /* orders by count: of the values at the ends of steps; NaN where there were none */
    double *inverse;     /* count by count: of the slopes of what comes out less what went in */
};

enum { VECTORS = 7 };

struct search { /* of the values of one step */
    double *guess, *found, *change, *residual, *effect, *answer, *row;
    double least;
    int64_t stalls, exchanges;
};

enum progress { AGAIN, SETTLED, UNSETTLED };

static double broyden_product(const double *one, const double *other, size_t count)
{
    double sum = 0.0;
    for (size_t place = 0; place < count; place++)
        sum += one[place] * other[place];
    return sum;
}

/* A value a step further, from that at its start and the differences that are known. */
static double broyden_extrapolated(const struct rule *rule, const struct solver *solver, size_t place, double value)
{
    double guess = 0.0;
    for (int64_t order = 0; order < rule->orders && !isnan(value); order++) {
        double *kept = &solver->differences[(size_t)order * solver->count + place];
        double difference = value - *kept;
        guess += value;
        *kept = value;
        value = difference;
    }
    return guess;
}

/* Begin with the values at the start of a step. `room` holds as many vectors as VECTORS says. */
static struct search broyden_begin(const struct rule *rule, const struct solver *solver, const double *values,
                                   double *room)
{
    size_t count = solver->count;
    struct search search = {room,
                            room + count,
                            room + 2 * count,
                            room + 3 * count,
                            room + 4 * count,
                            room + 5 * count,
                            room + 6 * count,
                            INFINITY,
                            0,
                            0};
    for (size_t place = 0; place < count; place++)
        search.guess[place] = broyden_extrapolated(rule, solver, place, values[place]);
    return search;
}

/* Let the slopes be those seen along the last change. */
static void broyden_learn(const struct rule *rule, const struct solver *solver, const struct search *search)
{
    size_t count = solver->count;
    for (size_t place = 0; place < count; place++)
        search->answer[place] = broyden_product(&solver->inverse[place * count], search->effect, count);
    double scale = broyden_product(search->change, search->answer, count);
    if (!(fabs(scale) > rule->flat * broyden_product(search->change, search->change, count)))
        return;
    for (size_t column = 0; column < count; column++) {
        search->row[column] = 0.0;
        for (size_t place = 0; place < count; place++)
            search->row[column] += search->change[place] * solver->inverse[place * count + column];
    }
    for (size_t place = 0; place < count; place++)
        for (size_t column = 0; column < count; column++)
            solver->inverse[place * count + column] +=
                (search->change[place] - search->answer[place]) * search->row[column] / scale;
}

/* Compare what came out with the guess that went in. Sets the residual and what it differs by from the one
 * before, and as a share of the largest values how much is left; whether it is within the tolerance. */
static bool broyden_close(const struct rule *rule, const struct solver *solver, const struct search *search,
                          double *left)
{
    bool close = true;
    *left = 0.0;
    for (size_t place = 0; place < solver->count; place++) {
        double found = search->found[place], before = search->residual[place];
        double largest = fmax(solver->largest[place], fabs(found)), residual = found - search->guess[place];
        search->residual[place] = residual;
        search->effect[place] = residual - before;
        *left = fmax(*left, fabs(residual) / (largest > 0.0 ? largest : 1.0));
        if (!(fabs(residual) <= fmax(rule->tolerance * fabs(found), rule->small * largest)))
            close = false;
    }
    return close;
}

/* Take what came out of the guess, and guess again. What is not real must come out as it went in: `size` bytes. */
static enum progress broyden_next(const struct rule *rule, const struct solver *solver, struct search *search,
                                  const void *went_in, const void *came_out, size_t size)
{
    size_t count = solver->count;
    double left;
    for (size_t place = 0; place < count; place++)
        if (!isfinite(search->found[place]))
            return UNSETTLED;
    bool close = broyden_close(rule, solver, search, &left);
    search->stalls = left >= 0.5 * search->least ? search->stalls + 1 : 0;
    bool rounded = search->exchanges >= rule->few && search->stalls >= rule->stalls && left <= rule->rounding;
    if ((close || rounded) && memcmp(went_in, came_out, size) == 0) {
        for (size_t place = 0; place < count; place++)
            solver->largest[place] = fmax(solver->largest[place], fabs(search->found[place]));
        return SETTLED;
    }
    search->least = fmin(search->least, left);
    if (search->exchanges++)
        broyden_learn(rule, solver, search);
    for (size_t place = 0; place < count; place++)
        search->change[place] = -broyden_product(&solver->inverse[place * count], search->residual, count);
    for (size_t place = 0; place < count; place++)
        search->guess[place] += search->change[place];
    return search->exchanges < rule->most_exchanges ? AGAIN : UNSETTLED;
}

#endif
