/* Steps what was included before and times it: set_up, initialize_all, step_all, record, COLUMNS, STEP_SIZE. */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { ROWS = 1024 };

static double rows[ROWS][COLUMNS];

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static void hand_over(FILE *file, size_t filled)
{
    if (file != NULL && fwrite(rows, sizeof rows[0], filled, file) != filled) {
        fprintf(stderr, "the trace cannot be written\n");
        exit(3);
    }
}

int main(int count, char **words)
{
    long steps = count > 1 ? atol(words[1]) : 0;
    FILE *file = count > 2 ? fopen(words[2], "wb") : NULL;
    size_t filled = 1;
    double start;
    set_up();
    if (initialize_all() != 0) {
        fprintf(stderr, "a component cannot be initialised\n");
        return 2;
    }
    record(rows[0]);
    start = now();
    for (long step = 0; step < steps; step++) {
        if (step_all((double)step * STEP_SIZE, STEP_SIZE) != 0) {
            fprintf(stderr, "step %ld failed\n", step);
            return 2;
        }
        if (filled == ROWS) {
            hand_over(file, filled);
            filled = 0;
        }
        record(rows[filled++]);
    }
    printf("%.9f\n", now() - start);
    hand_over(file, filled);
    if (file != NULL)
        fclose(file);
    return 0;
}
