/* Enclosures: all values that a number may have in a box of parameters, with its slopes by these.
 *
 * The C of a component, compiled as C++ with `enclosure` for `double`, then computes what holds for all points
 * of a box. Bounds are rounded outwards. What is not defined everywhere in the box, or takes too many ways, gives
 * the whole box up, so that nothing follows from it.
 *
 * A comparison that the box leaves undecided is decided both ways, one after the other: `joined` calls a
 * function again and again until all its ways are done, and joins what they return. In each way, the number
 * compared is narrowed to what the way means. A value that depends on the way has no slopes, since it may jump.
 *
 * LARGEST_BOX is defined before: the most sides of a box, the shaft angle included.
 */
#ifndef ENCLOSURE_H
#define ENCLOSURE_H

#include "../../../fmi/native/shell/python_arithmetic.h"
#include <setjmp.h>

#define MOST_WAYS 64 /* of a function */
#define MOST_DECISIONS 12 /* in one way */
#define LIBRARY_ERROR 4.0 /* largest error of a function of libm, in units of the last place; tested */

static int box_size = 0; /* parameters of the present box */

/* ---- ways */

struct frame {
    frame *caller;
    uint64_t serial; /* of the first value of each way */
    int depth, decisions;
    int choice[MOST_DECISIONS], choices[MOST_DECISIONS];
};
static frame *present = nullptr;
static jmp_buf given_up; /* of the present box */
static uint64_t serial = 0, fresh = 0; /* values of one serial are one value, see `joined` */

/* Nothing can be said of this box. */
[[noreturn]] static void give_up()
{
    longjmp(given_up, 1);
}

/* One of several ways, each in its turn. */
static int way_of(int ways)
{
    if (ways == 1) {
        return 0;
    }
    if (present == nullptr) {
        give_up(); /* a component that ends its start in several states */
    }
    frame &here = *present;
    if (here.depth == MOST_DECISIONS || ways > MOST_WAYS) {
        give_up();
    }
    if (here.depth == here.decisions) {
        here.choice[here.depth] = 0;
        here.choices[here.depth] = ways;
        here.decisions++;
    }
    serial = fresh += UINT64_C(1) << 28;
    return here.choice[here.depth++];
}

/* Turn to the next way; false where there is none left. */
static bool next_way(frame &here)
{
    while (here.decisions > 0 && here.choice[here.decisions - 1] == here.choices[here.decisions - 1] - 1) {
        here.decisions--;
    }
    if (here.decisions == 0) {
        return false;
    }
    here.choice[here.decisions - 1]++;
    here.depth = 0;
    serial = here.serial;
    return true;
}

/* ---- numbers */

static inline double below(double x)
{
    return x - (fabs(x) * 0x1p-52 + 0x1p-1021);
}

static inline double above(double x)
{
    return x + (fabs(x) * 0x1p-52 + 0x1p-1021);
}

struct span {
    double low, high;
};

static inline span spanned(double low, double high)
{
    return low <= high ? span{low, high} : span{-INFINITY, INFINITY}; /* NaN leaves it open */
}

/* A sum that is 0, or with 0, is exact. */
static inline bool exact(double a, double b)
{
    return a == 0.0 || b == 0.0 || a + b == 0.0;
}

static inline span operator+(span a, span b)
{
    const double low = a.low + b.low, high = a.high + b.high;
    return spanned(exact(a.low, b.low) ? low : below(low), exact(a.high, b.high) ? high : above(high));
}

static inline span operator-(span a)
{
    return {-a.high, -a.low};
}

static inline bool nothing(span a)
{
    return a.low == 0.0 && a.high == 0.0;
}

static inline double multiplied(double x, double y)
{
    if (x == 0.0 || y == 0.0) {
        return 0.0; /* an infinite bound is no value */
    }
    const double product = x * y;
    return product == 0.0 ? copysign(0x1p-1074, product) : product;
}

static inline span operator*(span a, span b)
{
    const double p[4] = {multiplied(a.low, b.low), multiplied(a.low, b.high), multiplied(a.high, b.low),
                         multiplied(a.high, b.high)};
    if (isnan(p[0] + p[1] + p[2] + p[3])) {
        return {-INFINITY, INFINITY};
    }
    double low = p[0], high = p[0];
    for (int i = 1; i < 4; i++) {
        low = p[i] < low ? p[i] : low;
        high = p[i] > high ? p[i] : high;
    }
    /* rounding changes no sign */
    return spanned(low > 0.0 ? fmax(below(low), 0.0) : low < 0.0 ? below(low) : 0.0,
                   high < 0.0 ? fmin(above(high), 0.0) : high > 0.0 ? above(high) : 0.0);
}

/* The square, of one number with itself. */
static inline span squared(span a)
{
    const span all = a * a;
    const double least = a.low > 0.0 ? a.low * a.low : a.high < 0.0 ? a.high * a.high : 0.0;
    return spanned(least > 0.0 ? fmax(below(least), 0.0) : 0.0, all.high);
}

/* One over a number; `not_zero` where that is known although a bound is 0. */
static inline span over(span a, bool not_zero = false)
{
    if (a.low > 0.0 || (not_zero && a.low == 0.0 && a.high > 0.0)) {
        return spanned(fmax(below(1.0 / a.high), 0.0), a.low > 0.0 ? above(1.0 / a.low) : INFINITY);
    }
    if (a.high < 0.0 || (not_zero && a.high == 0.0 && a.low < 0.0)) {
        return -over(-a, not_zero);
    }
    return {-INFINITY, INFINITY};
}

struct enclosure {
    span value;
    uint64_t serial; /* 0 for a constant of the source */
    bool varies; /* with the parameters of the box: it has slopes */
    bool not_zero; /* known, even where a bound is 0 */
    span slope[LARGEST_BOX];

    enclosure() = default;
    enclosure(double constant) : enclosure(spanned(constant, constant), 0, false) {}
    enclosure(int constant) : enclosure((double)constant) {}
    enclosure(int64_t constant) : enclosure((double)constant)
    {
        if (!(constant > -(INT64_C(1) << 53) && constant < INT64_C(1) << 53)) {
            value = {below(value.low), above(value.high)};
        }
    }
    enclosure(bool constant) : enclosure(constant ? 1.0 : 0.0) {}
    enclosure(span of, uint64_t number, bool slopes)
        : value(of), serial(number), varies(slopes), not_zero(of.low > 0.0 || of.high < 0.0)
    {
    }
};

/* A number that may jump with the parameters of the box. */
static enclosure without_slopes(span value)
{
    enclosure made(value, ++serial, true);
    for (int i = 0; i < box_size; i++) {
        made.slope[i] = {-INFINITY, INFINITY};
    }
    return made;
}

static enclosure unknown()
{
    return without_slopes({-INFINITY, INFINITY});
}

static inline bool is_open(span a)
{
    return a.low == -INFINITY && a.high == INFINITY;
}

/* A function of one number, with its values and its slope. */
static inline enclosure through(const enclosure &x, span value, span slope)
{
    if (is_open(value)) {
        return unknown();
    }
    enclosure made(value, ++serial, x.varies);
    for (int i = 0; x.varies && i < box_size; i++) {
        made.slope[i] = slope * x.slope[i];
    }
    return made;
}

/* A function of two numbers. */
static inline enclosure through(const enclosure &x, const enclosure &y, span value, span by_x, span by_y)
{
    if (!y.varies || !x.varies) {
        return y.varies ? through(y, value, by_y) : through(x, value, by_x);
    }
    if (is_open(value)) {
        return unknown();
    }
    enclosure made(value, ++serial, true);
    for (int i = 0; i < box_size; i++) {
        made.slope[i] = by_x * x.slope[i] + by_y * y.slope[i];
    }
    return made;
}

static const span ONE = {1.0, 1.0};

static inline enclosure operator-(const enclosure &x)
{
    return through(x, -x.value, -ONE);
}

static inline enclosure operator+(const enclosure &x, const enclosure &y)
{
    return through(x, y, x.value + y.value, ONE, ONE);
}

static inline enclosure operator-(const enclosure &x, const enclosure &y)
{
    return through(x, y, x.value + -y.value, ONE, -ONE);
}

static inline enclosure operator*(const enclosure &x, const enclosure &y)
{
    const bool square = x.serial != 0 && x.serial == y.serial;
    enclosure made = square ? through(x, squared(x.value), span{2.0, 2.0} * x.value)
                            : through(x, y, x.value * y.value, y.value, x.value);
    made.not_zero = x.not_zero && y.not_zero;
    return made;
}

static inline enclosure operator/(const enclosure &x, const enclosure &y)
{
    const span part = over(y.value, y.not_zero);
    if (is_open(part)) {
        give_up(); /* it may be divided by 0 */
    }
    const span value = x.value * part;
    enclosure made = through(x, y, value, part, -(value * part));
    made.not_zero = x.not_zero;
    return made;
}

/* ---- comparisons */

/* Whether something holds that may hold or not. */
static inline bool decided(bool may, bool may_not)
{
    return may && may_not ? way_of(2) == 0 : may;
}

/* Narrow the smaller and the larger of two numbers, where they are variables. */
static void ordered(enclosure *smaller, enclosure *larger, span small, span large, bool may_be_equal)
{
    if (smaller != nullptr) {
        smaller->value.high = fmin(small.high, large.high);
        smaller->not_zero |= large.high < 0.0 || (large.high == 0.0 && !may_be_equal);
    }
    if (larger != nullptr) {
        larger->value.low = fmax(small.low, large.low);
        larger->not_zero |= small.low > 0.0 || (small.low == 0.0 && !may_be_equal);
    }
}

/* x < y, or with `equal` x <= y. Where a number is a variable, it is narrowed to what the way means. */
static bool less(const enclosure &x, const enclosure &y, enclosure *x_here, enclosure *y_here, bool equal)
{
    const span a = x.value, b = y.value;
    const bool may = a.low < b.high || (equal && a.low == b.high);
    const bool may_not = a.high > b.low || (!equal && a.high == b.low);
    if (x.serial != 0 && x.serial == y.serial) {
        return equal;
    }
    const bool is = decided(may, may_not);
    if (is) {
        ordered(x_here, y_here, a, b, equal);
    } else {
        ordered(y_here, x_here, b, a, !equal);
    }
    return is;
}

static inline bool same(const enclosure &x, const enclosure &y)
{
    if (x.serial != 0 && x.serial == y.serial) {
        return true;
    }
    const bool thin = x.value.low == x.value.high && y.value.low == y.value.high;
    const bool may = x.value.low <= y.value.high && y.value.low <= x.value.high;
    return decided(may, !(may && thin));
}

/* A comparison of variables, which may be narrowed, and of values. */
#define COMPARISON(sign, x_first, equal) \
    static inline bool operator sign(enclosure &x, enclosure &y) \
    { \
        return x_first ? less(x, y, &x, &y, equal) : less(y, x, &y, &x, equal); \
    } \
    static inline bool operator sign(enclosure &x, const enclosure &y) \
    { \
        return x_first ? less(x, y, &x, nullptr, equal) : less(y, x, nullptr, &x, equal); \
    } \
    static inline bool operator sign(const enclosure &x, enclosure &y) \
    { \
        return x_first ? less(x, y, nullptr, &y, equal) : less(y, x, &y, nullptr, equal); \
    } \
    static inline bool operator sign(const enclosure &x, const enclosure &y) \
    { \
        return x_first ? less(x, y, nullptr, nullptr, equal) : less(y, x, nullptr, nullptr, equal); \
    }
COMPARISON(<, true, false)
COMPARISON(<=, true, true)
COMPARISON(>, false, false)
COMPARISON(>=, false, true)

static inline bool operator==(const enclosure &x, const enclosure &y)
{
    return same(x, y);
}

static inline bool operator!=(const enclosure &x, const enclosure &y)
{
    return !same(x, y);
}

/* ---- functions */

static inline span wide(span a)
{
    return spanned(a.low - LIBRARY_ERROR * (fabs(a.low) * 0x1p-52 + 0x1p-1021),
                   a.high + LIBRARY_ERROR * (fabs(a.high) * 0x1p-52 + 0x1p-1021));
}

static inline span within(span a, double low, double high)
{
    return {a.low < low ? low : a.low, a.high > high ? high : a.high};
}

/* A function that rises from `first` to `last`; outside it is not defined, or not computed. */
#define RISING(name, first, last) \
    static inline span span_##name(span x) \
    { \
        if (!(x.low >= (first) && x.high <= (last))) { \
            give_up(); \
        } \
        return wide({name(x.low), name(x.high)}); \
    }
RISING(sqrt, 0.0, INFINITY)
RISING(asin, -1.0, 1.0)
RISING(atan, -1e308, 1e308)
RISING(exp, -700.0, 700.0)
RISING(expm1, -700.0, 700.0)
RISING(log, 1e-300, 1e308)
RISING(log1p, -1.0 + 1e-15, 1e308)
RISING(sinh, -700.0, 700.0)
RISING(tanh, -1e308, 1e308)
RISING(cbrt, -1e308, 1e308)
RISING(asinh, -1e300, 1e300)

static inline span span_acos(span x)
{
    if (!(x.low >= -1.0 && x.high <= 1.0)) {
        give_up();
    }
    return wide({acos(x.high), acos(x.low)});
}

static inline span span_cosh(span x)
{
    const double nearest = x.low > 0.0 ? x.low : x.high < 0.0 ? x.high : 0.0;
    const double farthest = fabs(x.low) > fabs(x.high) ? x.low : x.high;
    span_sinh(x); /* gives up where it is too large */
    return wide({cosh(nearest), cosh(farthest)});
}

/* The sine: is one of its crests, at pi/2 + 2 n pi, in the span, and one of its troughs? In doubt both are. */
static span span_sine(span x, double quarter)
{
    if (!(fabs(x.low) < 1e8 && fabs(x.high) < 1e8)) {
        return {-1.0, 1.0};
    }
    const double turn = 6.283185307179586, doubt = 1e-14 * (2.0 + fabs(x.low) + fabs(x.high));
    double low = quarter == 0.0 ? sin(x.low) : cos(x.low), high = quarter == 0.0 ? sin(x.high) : cos(x.high);
    if (low > high) {
        const double other = low;
        low = high;
        high = other;
    }
    for (int crest = 0; crest < 2; crest++) {
        const double at = 1.5707963267948966 * (1.0 - quarter) + (crest ? 0.0 : 3.141592653589793);
        if (floor((x.high + doubt - at) / turn) > floor((x.low - doubt - at) / turn)) {
            *(crest ? &high : &low) = crest ? 1.0 : -1.0;
        }
    }
    return within(wide({low, high}), -1.0, 1.0);
}

static inline span span_sin(span x)
{
    return span_sine(x, 0.0);
}

static inline span span_cos(span x)
{
    return span_sine(x, 1.0);
}

static inline span span_fabs(span x)
{
    const double low = fabs(x.low), high = fabs(x.high);
    return {x.low <= 0.0 && x.high >= 0.0 ? 0.0 : low < high ? low : high, low > high ? low : high};
}

static inline span complement(span y) /* 1 - y^2, of what is not above 1 */
{
    const span rest = ONE + -squared(y);
    return {fmax(rest.low, 0.0), fmax(rest.high, 0.0)};
}

/* Functions of one number x, each with its slope there, where its values are y. */
#define FUNCTION(name, by_x) \
    static enclosure name(const enclosure &number) \
    { \
        const span x = number.value, y = span_##name(x); \
        (void)x; \
        return through(number, y, by_x); \
    }
FUNCTION(sqrt, over(span{2.0, 2.0} * y))
FUNCTION(sin, span_cos(x))
FUNCTION(cos, -span_sin(x))
FUNCTION(asin, over(span_sqrt(complement(x))))
FUNCTION(acos, -over(span_sqrt(complement(x))))
FUNCTION(atan, over(ONE + squared(x)))
FUNCTION(exp, y)
FUNCTION(expm1, y + ONE)
FUNCTION(log, over(x))
FUNCTION(log1p, over(ONE + x))
FUNCTION(sinh, span_cosh(x))
FUNCTION(cosh, span_sinh(x))
FUNCTION(tanh, complement(y))
FUNCTION(cbrt, over(span{3.0, 3.0} * squared(y)))
FUNCTION(asinh, over(span_sqrt(ONE + squared(x))))
FUNCTION(fabs, (x.low >= 0.0 ? ONE : x.high <= 0.0 ? -ONE : span{-1.0, 1.0}))

static enclosure tan(const enclosure &x)
{
    return sin(x) / cos(x);
}

/* Anywhere but across the half line on which it jumps. */
static enclosure atan2(const enclosure &y, const enclosure &x)
{
    const span a = y.value, b = x.value;
    if (!(b.low > 0.0 || a.low > 0.0 || a.high < 0.0)) {
        return without_slopes(wide({-3.141592653589793, 3.141592653589793})); /* 0 at the origin, as in Python */
    }
    double low = INFINITY, high = -INFINITY;
    for (int corner = 0; corner < 4; corner++) {
        const double angle = atan2(corner & 1 ? a.low : a.high, corner & 2 ? b.low : b.high);
        low = angle < low ? angle : low;
        high = angle > high ? angle : high;
    }
    const span part = over(squared(a) + squared(b));
    return through(y, x, wide(spanned(low, high)), b * part, -(a * part));
}

/* A whole number: of a number whose whole part is in doubt, each in its turn. */
struct whole {
    double low, high;
};

static inline whole floor(const enclosure &x)
{
    return {floor(x.value.low), floor(x.value.high)};
}

static inline whole ceil(const enclosure &x)
{
    return {ceil(x.value.low), ceil(x.value.high)};
}

static inline whole trunc(const enclosure &x)
{
    return {trunc(x.value.low), trunc(x.value.high)};
}

static int64_t python_whole(whole number)
{
    if (!(number.high - number.low < MOST_WAYS && fabs(number.low) < 1e15)) {
        give_up();
    }
    return (int64_t)number.low + way_of((int)(number.high - number.low) + 1);
}

static inline int64_t python_whole(const enclosure &x)
{
    return python_whole(trunc(x));
}

static enclosure python_modulo_float(const enclosure &x, const enclosure &divisor)
{
    return x - divisor * enclosure(python_whole(floor(x / divisor)));
}

static enclosure python_floor_division_float(const enclosure &x, const enclosure &divisor)
{
    return enclosure(python_whole(floor(x / divisor)));
}

static enclosure pow(const enclosure &x, const enclosure &power)
{
    return exp(power * log(x));
}

static enclosure copysign(const enclosure &x, enclosure sign)
{
    return sign >= enclosure(0.0) ? fabs(x) : -fabs(x);
}

PYTHON_ITEM(float, enclosure, (give_up(), unknown()))

/* ---- results */

static inline bool alike(const enclosure &, const enclosure &)
{
    return true;
}

static inline bool alike(int64_t a, int64_t b)
{
    return a == b;
}

static inline bool alike(bool a, bool b)
{
    return a == b;
}

/* All values of two ways: of one number, or of two that differ, between which it may jump. */
static void join(enclosure &a, const enclosure &b)
{
    const span all = {fmin(a.value.low, b.value.low), fmax(a.value.high, b.value.high)};
    const bool constant = a.serial == 0 && b.serial == 0 && all.low == all.high;
    if (a.serial != 0 && a.serial == b.serial) {
        a.value = all;
        a.not_zero &= b.not_zero;
    } else if (!constant) {
        a = without_slopes(all);
    }
}

static inline void join(int64_t &, int64_t) {}

static inline void join(bool &, bool) {}

template <class T, int n> static inline bool alike(const T (&a)[n], const T (&b)[n])
{
    for (int i = 0; i < n; i++) {
        if (!alike(a[i], b[i])) {
            return false;
        }
    }
    return true;
}

template <class T, int n> static inline void join(T (&a)[n], const T (&b)[n])
{
    for (int i = 0; i < n; i++) {
        join(a[i], b[i]);
    }
}

#define MOST_KINDS 4 /* results of a function that differ in a whole number or a truth value */

/* The results of all ways of a function: those that agree in whole numbers and truth values become one. */
template <class Result, class Function> static Result joined(Function function)
{
    frame here;
    Result results[MOST_KINDS];
    int kinds = 0, ways = 0;
    here.caller = present;
    here.serial = serial;
    here.depth = here.decisions = 0;
    present = &here;
    do {
        const Result found = function();
        int kind = 0;
        while (kind < kinds && !alike(results[kind], found)) {
            kind++;
        }
        if (kind == MOST_KINDS || ++ways > MOST_WAYS) {
            give_up();
        }
        if (kind == kinds) {
            results[kind] = found;
            kinds = kind + 1;
        } else {
            join(results[kind], found);
        }
    } while (next_way(here));
    present = here.caller;
    if (ways > 1) {
        serial = fresh += UINT64_C(1) << 28;
    }
    return results[way_of(kinds)];
}

#endif
