/* Dual numbers: a value, and its derivative in one direction, which goes along with every operation.
 *
 * The value is to the bit what plain numbers give. At a kink the derivative is that of the branch taken. What
 * has no derivative in the direction is not differentiated: 0 times an infinite slope counts as 0.
 */
#ifndef DUAL_H
#define DUAL_H

#include "python_arithmetic.h"

#define DUAL_PI 3.14159265358979323846

typedef struct {
    double value;
    double tangent;
} dual;

static inline dual dual_made(double value, double tangent)
{
    dual made = {value, tangent};
    return made;
}

static inline dual dual_of(double value)
{
    return dual_made(value, 0.0);
}

/* What a slope makes of a tangent. */
#define DUAL_ALONG(slope, along) ((along) < 0.0 || (along) > 0.0 ? (slope) * (along) : 0.0 * (along))

static inline dual dual_negated(dual x)
{
    return dual_made(-x.value, -x.tangent);
}

static inline dual dual_sum(dual x, dual y)
{
    return dual_made(x.value + y.value, x.tangent + y.tangent);
}

static inline dual dual_difference(dual x, dual y)
{
    return dual_made(x.value - y.value, x.tangent - y.tangent);
}

static inline dual dual_product(dual x, dual y)
{
    return dual_made(x.value * y.value, DUAL_ALONG(y.value, x.tangent) + DUAL_ALONG(x.value, y.tangent));
}

static inline dual dual_quotient(dual x, dual y)
{
    const double ratio = x.value / y.value;
    return dual_made(ratio, DUAL_ALONG(1.0 / y.value, x.tangent) - DUAL_ALONG(ratio / y.value, y.tangent));
}

/* ---- functions of one number, each with its slope at x, where its value is y */

#define DUAL_FUNCTION(name, slope) \
    static inline dual dual_##name(dual number) \
    { \
        const double x = number.value, y = name(x); \
        (void)x; \
        return dual_made(y, DUAL_ALONG(slope, number.tangent)); \
    }
DUAL_FUNCTION(acos, -1.0 / sqrt((1.0 - x) * (1.0 + x)))
DUAL_FUNCTION(acosh, 1.0 / sqrt((x - 1.0) * (x + 1.0)))
DUAL_FUNCTION(asin, 1.0 / sqrt((1.0 - x) * (1.0 + x)))
DUAL_FUNCTION(asinh, 1.0 / hypot(x, 1.0))
DUAL_FUNCTION(atan, 1.0 / (1.0 + x * x))
DUAL_FUNCTION(atanh, 1.0 / ((1.0 - x) * (1.0 + x)))
DUAL_FUNCTION(cbrt, 1.0 / (3.0 * y * y))
DUAL_FUNCTION(cos, -sin(x))
DUAL_FUNCTION(cosh, sinh(x))
DUAL_FUNCTION(erf, 2.0 / sqrt(DUAL_PI) * exp(-x * x))
DUAL_FUNCTION(erfc, -2.0 / sqrt(DUAL_PI) * exp(-x * x))
DUAL_FUNCTION(exp, y)
DUAL_FUNCTION(expm1, y + 1.0)
DUAL_FUNCTION(fabs, x < 0.0 ? -1.0 : 1.0)
DUAL_FUNCTION(log, 1.0 / x)
DUAL_FUNCTION(log10, 1.0 / (x * log(10.0)))
DUAL_FUNCTION(log1p, 1.0 / (1.0 + x))
DUAL_FUNCTION(log2, 1.0 / (x * log(2.0)))
DUAL_FUNCTION(sin, cos(x))
DUAL_FUNCTION(sinh, cosh(x))
DUAL_FUNCTION(sqrt, 0.5 / y)
DUAL_FUNCTION(tan, 1.0 + y * y)
DUAL_FUNCTION(tanh, (1.0 - y) * (1.0 + y))

/* ---- functions of two numbers */

static inline dual dual_atan2(dual y, dual x)
{
    const double square = x.value * x.value + y.value * y.value;
    return dual_made(atan2(y.value, x.value),
                     DUAL_ALONG(x.value / square, y.tangent) - DUAL_ALONG(y.value / square, x.tangent));
}

static inline dual dual_copysign(dual x, dual sign)
{
    const double value = copysign(x.value, sign.value);
    return dual_made(value, copysign(1.0, value) * copysign(1.0, x.value) * x.tangent);
}

static inline dual dual_pow(dual x, dual power)
{
    const double value = pow(x.value, power.value);
    return dual_made(value, DUAL_ALONG(power.value * pow(x.value, power.value - 1.0), x.tangent)
                                + DUAL_ALONG(value * log(x.value), power.tangent));
}

/* The root of a function that a search has found, with the derivative that follows from its equation. */
static inline dual dual_at_root(dual root, dual value, dual slope)
{
    return dual_made(root.value, root.tangent - DUAL_ALONG(1.0 / slope.value, value.tangent));
}

/* Whether a factor is 0 and stays so. */
static inline bool dual_absent(dual factor)
{
    return factor.value == 0.0 && factor.tangent == 0.0;
}

/* A remainder: so many divisors less than the number. */
static inline dual dual_rest(dual x, dual divisor, double rest)
{
    return dual_made(rest, x.tangent - DUAL_ALONG(floor((x.value - rest) / divisor.value + 0.5), divisor.tangent));
}

static inline dual dual_fmod(dual x, dual divisor)
{
    return dual_rest(x, divisor, fmod(x.value, divisor.value));
}

static inline dual python_modulo_dual(dual x, dual divisor)
{
    return dual_rest(x, divisor, python_modulo_float(x.value, divisor.value));
}

static inline dual python_floor_division_dual(dual x, dual divisor)
{
    return dual_of(python_floor_division_float(x.value, divisor.value));
}

PYTHON_ITEM(dual, dual, dual_of(NAN))

#endif
