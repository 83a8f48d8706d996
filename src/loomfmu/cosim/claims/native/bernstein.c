/* Where a polynomial between two samples changes its sign: as bernstein.py finds it, in the same operations. */

#include <stddef.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

enum { MOST = 6 }; /* points: those of a quintic */

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

/* Of a polynomial of up to MOST points that changes its sign once: halved until nothing is left between. */
EXPORT double sign_change(const double *points, size_t count)
{
    const int begins_negative = points[0] < 0.0;
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
