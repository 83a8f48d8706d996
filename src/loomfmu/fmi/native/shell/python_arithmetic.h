/* Integer and remainder arithmetic as Python has it, for the translated components. */
#ifndef PYTHON_ARITHMETIC_H
#define PYTHON_ARITHMETIC_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

/* The largest integer that a float becomes: room is left for what is added to it. Sums and products beyond
 * 64 bits wrap (-fwrapv); Python's do not, so components keep their integers within 64 bits. */
#define PYTHON_LARGEST (INT64_C(1) << 60)

/* A whole number as an integer. Python has no largest one and raises on what is not finite; here the largest
 * stands for a larger one, and 0 for NaN. The results then differ from Python's without a message. */
static inline int64_t python_whole(double value)
{
    if (value >= (double)PYTHON_LARGEST) {
        return PYTHON_LARGEST;
    }
    if (value <= -(double)PYTHON_LARGEST) {
        return -PYTHON_LARGEST;
    }
    return isnan(value) ? 0 : (int64_t)value;
}

/* Remainder with the sign of the divisor; 0 where Python raises. */
static inline int64_t python_modulo_int(int64_t value, int64_t divisor)
{
    int64_t rest;
    if (divisor == 0 || divisor == -1) {
        return 0;
    }
    rest = value % divisor;
    return rest != 0 && (rest < 0) != (divisor < 0) ? rest + divisor : rest;
}

static inline int64_t python_floor_division_int(int64_t value, int64_t divisor)
{
    if (divisor == 0) {
        return 0;
    }
    if (divisor == -1) {
        return value == INT64_MIN ? INT64_MAX : -value;
    }
    return value / divisor - (value % divisor != 0 && (value < 0) != (divisor < 0) ? 1 : 0);
}

/* Remainder with the sign of the divisor, as CPython's float_rem. */
static inline double python_modulo_float(double value, double divisor)
{
    double rest = fmod(value, divisor);
    if (rest != 0.0) {
        return (divisor < 0.0) != (rest < 0.0) ? rest + divisor : rest;
    }
    return copysign(0.0, divisor);
}

/* As CPython's float_floor_div: consistent with the remainder, which floor(a / b) is not. */
static inline double python_floor_division_float(double value, double divisor)
{
    double rest = fmod(value, divisor);
    double quotient = (value - rest) / divisor;
    double whole;
    if (rest != 0.0 && (divisor < 0.0) != (rest < 0.0)) {
        quotient -= 1.0;
    }
    if (quotient == 0.0) {
        return copysign(0.0, value / divisor);
    }
    whole = floor(quotient);
    return quotient - whole > 0.5 ? whole + 1.0 : whole;
}

/* An element of an array, a negative index counted from its end. Where Python raises nothing is read: NaN, which
 * is refused in an output, the largest integer or false stands for it; where an element cannot be written, for all. */
#define PYTHON_ITEM(name, type, absent) \
    static inline type python_item_##name(const type *array, int64_t count, int64_t index) \
    { \
        const int64_t place = index < 0 ? index + count : index; \
        return place >= 0 && place < count ? array[place] : absent; \
    } \
    static inline void python_put_##name(type *array, int64_t count, int64_t index, type value) \
    { \
        const int64_t place = index < 0 ? index + count : index; \
        int64_t each; \
        if (place >= 0 && place < count) { \
            array[place] = value; \
            return; \
        } \
        for (each = 0; each < count; each++) { \
            array[each] = absent; \
        } \
    }
PYTHON_ITEM(float, double, NAN)
PYTHON_ITEM(int, int64_t, PYTHON_LARGEST)
PYTHON_ITEM(bool, bool, false)

#endif
