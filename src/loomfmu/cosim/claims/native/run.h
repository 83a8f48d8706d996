/* A recorded run: its samples, what is said of each signal, and the memory that judging takes. */

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* How each function that is called from outside begins: its result if no memory is left. */
#ifdef __wasm__
#define BEGIN(run, result) release(&(run)->scratch)
#define GIVE_UP(run) __builtin_trap()
#else
#include <setjmp.h>
#define BEGIN(run, result)        \
    release(&(run)->scratch);     \
    if (setjmp((run)->full) != 0) \
    return result
#define GIVE_UP(run) longjmp((run)->full, 1)
#endif

enum { MOST_RATES = 2 };
static const double TURN = 6.283185307179586;
static const double SAME = 1e-11; /* of the largest value: extremes that close are equal, and the first is named */

struct column {
    const char *first;
    ptrdiff_t stride; /* bytes from one sample to the next */
};

struct signal {
    const char *name, *about;
    struct column column;
    int rate, valid_if, error, lowest, highest; /* other signals by their numbers, or -1 */
    struct motion *motions[MOST_RATES + 1];     /* by the number of rates that count */
};

struct room { /* a piece of memory, freed with all others */
    struct room *next;
    double contents[];
};

struct mover {
    double angle; /* the number of a signal; -1 for what turns at a speed of its own */
    double turns; /* 1 for an angle that goes on for whole turns, 0 for one that may swing */
    double turn;  /* a whole turn in its unit */
    double speed;
};

struct run {
    ptrdiff_t samples;
    struct column time;
    const char *cut_short; /* how far it came, or an empty text */
    struct signal *signals;
    int count, space;
    int shaft; /* the number of the main shaft's angle, or -1 */
    const struct mover *movers; /* of the question: what turns the instances that it is about */
    ptrdiff_t moving;
    struct room *kept, *scratch;
    const char *note; /* of the last verdict */
#ifndef __wasm__
    jmp_buf full; /* where a function returns to that finds no memory */
#endif
};

static double at_sample(struct column column, ptrdiff_t place)
{
    return *(const double *)(const void *)(column.first + place * column.stride);
}

static double time_at(const struct run *run, ptrdiff_t place)
{
    return at_sample(run->time, place);
}

static double sample_of(const struct run *run, int signal, ptrdiff_t place)
{
    return at_sample(run->signals[signal].column, place);
}

static double last_of(const struct run *run, int signal)
{
    return sample_of(run, signal, run->samples - 1);
}

static double end_of(const struct run *run)
{
    return time_at(run, run->samples - 1);
}

/* The number of samples before a time, or those at it included: its place in their order. */
static ptrdiff_t samples_before(const struct run *run, double time, bool included)
{
    ptrdiff_t low = 0, high = run->samples;
    while (low < high) {
        ptrdiff_t middle = low + (high - low) / 2;
        double there = time_at(run, middle);
        if (there < time || (included && there <= time) || isnan(time))
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* ---- memory */

static void *take(struct run *run, struct room **rooms, size_t size)
{
    struct room *room = malloc(sizeof *room + size);
    if (room == NULL)
        GIVE_UP(run);
    room->next = *rooms;
    *rooms = room;
    return room->contents;
}

static void release(struct room **rooms)
{
    while (*rooms != NULL) {
        struct room *next = (*rooms)->next;
        free(*rooms);
        *rooms = next;
    }
}

/* A list with room for one more, which may have moved. */
static void *with_room(struct run *run, void *list, ptrdiff_t count, ptrdiff_t *space, size_t size)
{
    if (count < *space)
        return list;
    *space = 2 * count + 8;
    void *larger = take(run, &run->scratch, (size_t)*space * size);
    if (count > 0)
        memcpy(larger, list, (size_t)count * size);
    return larger;
}

/* ---- lists */

struct times {
    ptrdiff_t count, space;
    double *list;
};

struct moment { /* a value, and when it is reached */
    double value, time;
};

struct moments {
    ptrdiff_t count, space;
    struct moment *list;
};

struct stretch { /* of time; whole if it begins and ends within the run */
    double start, end;
    bool whole;
};

struct stretches {
    ptrdiff_t count, space;
    struct stretch *list;
};

static void add_time(struct run *run, struct times *times, double time)
{
    times->list = with_room(run, times->list, times->count, &times->space, sizeof *times->list);
    times->list[times->count++] = time;
}

static void add_moment(struct run *run, struct moments *all, double value, double time)
{
    struct moment added = {value, time};
    all->list = with_room(run, all->list, all->count, &all->space, sizeof added);
    all->list[all->count++] = added;
}

static void add_stretch(struct run *run, struct stretches *all, double start, double end, bool whole)
{
    struct stretch added = {start, end, whole};
    all->list = with_room(run, all->list, all->count, &all->space, sizeof *all->list);
    all->list[all->count++] = added;
}

static int by_value(const void *one, const void *other)
{
    double a = *(const double *)one, b = *(const double *)other;
    return (a > b) - (a < b);
}

static int by_start(const void *one, const void *other)
{
    const struct stretch *a = one, *b = other;
    if (a->start != b->start)
        return a->start < b->start ? -1 : 1;
    if (a->end != b->end)
        return a->end < b->end ? -1 : 1;
    return (int)a->whole - (int)b->whole;
}

/* Times in order, each once. */
static void order_times(struct times *times)
{
    ptrdiff_t kept = 0;
    if (times->count > 0)
        qsort(times->list, (size_t)times->count, sizeof *times->list, by_value);
    for (ptrdiff_t place = 0; place < times->count; place++)
        if (kept == 0 || times->list[place] != times->list[kept - 1])
            times->list[kept++] = times->list[place];
    times->count = kept;
}

static void order_stretches(struct stretches *all)
{
    if (all->count > 0)
        qsort(all->list, (size_t)all->count, sizeof *all->list, by_start);
}

/* ---- texts */

static const char *text(struct run *run, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    int length = vsnprintf(NULL, 0, format, values);
    va_end(values);
    char *made = take(run, &run->scratch, (size_t)length + 1);
    va_start(values, format);
    (void)vsnprintf(made, (size_t)length + 1, format, values);
    va_end(values);
    return made;
}

static const char *degrees(struct run *run, double angle)
{
    return text(run, "%.7g deg", angle / 0.017453292519943295);
}

/* ---- arithmetic as Python has it */

static double larger(double one, double other)
{
    return other > one ? other : one;
}

static double smaller(double one, double other)
{
    return other < one ? other : one;
}

static double remainder_of(double value, double turn)
{
    double rest = fmod(value, turn);
    return rest != 0.0 ? (rest < 0.0 ? rest + turn : rest) : 0.0;
}
