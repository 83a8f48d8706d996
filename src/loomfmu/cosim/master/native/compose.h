/* Judges what follows from the time alone, as composed.py does: its steps are divided where a worst value may lie. */

struct judges { /* the functions of the other library, with a run */
    bool (*judge)(void *, const double *, const char *, void *);
    bool (*settle)(void *, const double *, void *, double, double, double, double);
    void (*renew)(void *, ptrdiff_t);
    const char *(*note)(const void *);
    void *run;
};

struct asked { /* a question as the rules take it, its words, and the number of its verdict */
    const double *list;
    const char *words;
    int64_t number;
};

struct recorded { /* the samples of the run itself, and how many numbers are from one to the next */
    const double *first;
    int64_t stride;
};

struct moving { /* of a question: a signal, or what holds its lowest values times a sign */
    int64_t asked, held;
    double sign;
    const dual *values; /* a sample after the other, each `stride` after the one before */
    int64_t stride;
    struct recorded recorded;
    double start, width;    /* of the window of the shaft's angle in which it counts; negative without one */
    const int64_t *windows; /* signals that are all positive where its extremes lie */
    size_t window_count;
};

struct latch { /* holds the lowest values of a signal times a sign */
    double *values;
    int64_t base;
    double sign;
};

struct image { /* the memory of a component at its start */
    void *to;
    const void *from;
    size_t size;
};

struct composed {
    const struct image *images;
    size_t image_count;
    const struct moving *motions;
    size_t motion_count;
    const struct latch *latches;
    size_t latch_count;
    const struct asked *asked; /* for rows alone */
    size_t asked_count;
    struct recorded run, run_angle; /* times and angles of the shaft */
    const struct tangents *tangents;
    void (*express)(int64_t); /* computes expressions at so many samples; NULL where there are none */
    struct judges judges;
    double *times, *new_times, *merged_times; /* of samples, for as many as there is room */
    dual *rows, *new_rows, *merged_rows, *starts, *sizes;
    double *lowest, *left;
    char *inside, *may_be, *unsure;
    int64_t room, count_column, angle; /* the shaft's angle among the signals */
    int64_t count, more, complete;     /* samples; times of further ones; whether nothing broke off */
    double share;                      /* see composed.py */
};

enum { PARTS = 8, EARLY = 2, ROUNDS = 16 }; /* of a step that is divided; of dividing it about its minimum, and at all */
static const double BESIDE = 1.0 / 32.0;    /* of a step: samples on both sides of its minimum */
static const double NARROW = 1e-12;         /* of the run: steps that are divided no more, which may hold a jump */
/* of the worst and of the largest value: what a cubic, and rounding, may leave */
static const double EXACT = 1e-11, ROUNDED = 1e-13;
static const double DOUBT = 0.25; /* of the difference between second rates over a step, see curves.h */
static const double EDGE = 1e-12; /* rad: what rounding leaves of an edge of a window */
static const double TURN = 6.283185307179586;

/* All signals at times from 0 on; false where they are not finite. */
static bool sample_at(const struct composed *composed, int64_t count, const double *times, dual *rows)
{
    const size_t kept = composed->tangents->kept_count;
    double nothing = 0.0;
    for (size_t place = 0; place < composed->image_count; place++)
        memcpy(composed->images[place].to, composed->images[place].from, composed->images[place].size);
    for (int64_t step = 0; step + 1 < count; step++) {
        composed->starts[step] = (dual){times[step], 1.0};
        composed->sizes[step] = (dual){times[step + 1] - times[step], 0.0};
    }
    step_tangents(composed->tangents, count - 1, composed->starts, composed->sizes, NULL, rows);
    for (size_t place = 0; place < (size_t)count * kept; place++)
        nothing += rows[place].value - rows[place].value + (rows[place].tangent - rows[place].tangent);
    return nothing == 0.0;
}

static int by_size(const void *one, const void *other)
{
    const double first = *(const double *)one, second = *(const double *)other;
    return (first > second) - (first < second);
}

/* Bring times in order, each once; returns how many are left. */
static int64_t in_order(double *times, int64_t count)
{
    int64_t kept = 1;
    qsort(times, (size_t)count, sizeof *times, by_size);
    for (int64_t place = 1; place < count; place++)
        if (times[place] != times[kept - 1])
            times[kept++] = times[place];
    return kept;
}

/* Take the further samples in, except at times that are known. */
static void merge(struct composed *composed)
{
    const size_t kept = composed->tangents->kept_count, size = kept * sizeof(dual);
    int64_t merged = 0, old = 0, new = 0;
    while (old < composed->count || new < composed->more) {
        const bool known =
            old < composed->count && (new == composed->more || composed->times[old] <= composed->new_times[new]);
        const double time = known ? composed->times[old] : composed->new_times[new];
        const dual *row = known ? composed->rows + (size_t)old * kept : composed->new_rows + (size_t)new * kept;
        memcpy(composed->merged_rows + (size_t)merged * kept, row, size);
        composed->merged_times[merged++] = time;
        old += known;
        new += new < composed->more && composed->new_times[new] == time;
    }
    memcpy(composed->times, composed->merged_times, (size_t)merged * sizeof(double));
    memcpy(composed->rows, composed->merged_rows, (size_t)merged * size);
    composed->count = merged;
}

/* How far an angle is beyond another one, within a turn. */
static double beyond(double angle, double other)
{
    return angle - other - TURN * floor((angle - other) / TURN);
}

static bool is_at(const struct moving *moving, double angle)
{
    return moving->width < 0.0 || beyond(angle + EDGE, moving->start) <= moving->width + 2.0 * EDGE;
}

static double recorded_at(struct recorded recorded, int64_t sample)
{
    return recorded.first[sample * recorded.stride];
}

/* Equal steps, and the worst samples of the run: their number, 0 where there is no room. */
static int64_t first_times(const struct composed *composed, int64_t steps, int64_t samples)
{
    const double end = recorded_at(composed->run, samples - 1), step = end / (double)steps;
    int64_t count = steps + 1;
    if (count + (int64_t)composed->motion_count > composed->room)
        return 0;
    for (int64_t place = 0; place < steps; place++)
        composed->times[place] = (double)place * step;
    composed->times[steps] = end;
    for (size_t place = 0; place < composed->motion_count; place++) {
        const struct moving *moving = &composed->motions[place];
        double lowest = INFINITY, time = 0.0;
        for (int64_t sample = 0; sample < samples; sample++) {
            const double value = moving->sign * recorded_at(moving->recorded, sample);
            if (value < lowest && is_at(moving, recorded_at(composed->run_angle, sample))) {
                lowest = value;
                time = recorded_at(composed->run, sample);
            }
        }
        composed->times[count++] = time;
    }
    return in_order(composed->times, count);
}

/* What a motion times a sign does not go below on each step. */
static void lowest_of(const struct composed *composed, const dual *first, int64_t stride, double sign)
{
    find_lowest(composed->count, DOUBT, sign, composed->times, &first->value, &first->tangent, 2 * stride,
                composed->lowest);
}

static bool is_wide(const struct composed *composed, int64_t place)
{
    return composed->times[place + 1] - composed->times[place] > NARROW * composed->times[composed->count - 1];
}

/* Ask for a sample at a time. Without room for it nothing is divided any more. */
static void add(struct composed *composed, double time)
{
    if (composed->count + composed->more < composed->room)
        composed->new_times[composed->more++] = time;
    else
        composed->complete = false;
}

static void divide_evenly(struct composed *composed, int64_t place)
{
    const double start = composed->times[place], size = composed->times[place + 1] - start;
    for (int part = 1; part < PARTS; part++)
        add(composed, start + size * ((double)part / PARTS));
}

/* Divide a step about the minimum of its cubic, times a sign. */
static void divide_at_minimum(struct composed *composed, int64_t place, const dual *values, int64_t stride, double sign)
{
    const double start = composed->times[place], size = composed->times[place + 1] - start;
    const double rise = sign * (values[stride].value - values->value);
    const double before = sign * size * values->tangent, after = sign * size * values[stride].tangent;
    const double square = 3.0 * rise - 2.0 * before - after, cube = before + after - 2.0 * rise;
    const double root = sqrt(square * square - 3.0 * cube * before); /* NaN where it only falls or only rises */
    double share = square > 0.0 ? -before / (square + root) : (root - square) / (3.0 * cube);
    if (!(share > BESIDE && share < 1.0 - BESIDE))
        share = values[stride].value * sign < values->value * sign ? 1.0 - BESIDE : BESIDE;
    for (int side = -1; side <= 1; side++)
        if (share + side * BESIDE > 0.0 && share + side * BESIDE < 1.0)
            add(composed, start + size * (share + side * BESIDE));
}

/* Divide the steps within which alone a signal may be where its extremes lie. */
static void divide_hidden(struct composed *composed, const struct moving *moving)
{
    const int64_t kept = (int64_t)composed->tangents->kept_count, count = composed->count;
    memset(composed->inside, 1, (size_t)count);
    memset(composed->may_be, 1, (size_t)count);
    for (size_t window = 0; window < moving->window_count; window++) {
        const dual *first = composed->rows + moving->windows[window];
        lowest_of(composed, first, kept, -1.0);
        for (int64_t place = 0; place < count; place++)
            composed->inside[place] &= first[place * kept].value > 0.0;
        for (int64_t place = 0; place + 1 < count; place++)
            composed->may_be[place] &= -composed->lowest[place] > 0.0;
    }
    for (int64_t place = 0; moving->window_count > 0 && place + 1 < count; place++)
        if (composed->may_be[place] && !composed->inside[place] && !composed->inside[place + 1] &&
            is_wide(composed, place))
            divide_evenly(composed, place);
}

static dual angle_at(const struct composed *composed, int64_t place)
{
    const dual none = {0.0, 0.0};
    const size_t first = (size_t)place * composed->tangents->kept_count;
    return composed->angle < 0 ? none : composed->rows[first + (size_t)composed->angle];
}

/* Divide the steps that may hold the worst value of a motion; returns how far that may be off. */
static double divide_doubtful(struct composed *composed, const struct moving *moving, int round)
{
    const dual *values = moving->values;
    double best = INFINITY, largest = 0.0, left = 0.0;
    for (int64_t place = 0; place < composed->count; place++) {
        const double value = values[place * moving->stride].value;
        if (is_at(moving, angle_at(composed, place).value) && moving->sign * value < best)
            best = moving->sign * value;
        largest = fabs(value) > largest ? fabs(value) : largest;
    }
    if (best == INFINITY)
        return 0.0;
    lowest_of(composed, values, moving->stride, moving->sign);
    const double most = EXACT * fabs(best) + ROUNDED * largest;
    for (int64_t place = 0; place + 1 < composed->count; place++) {
        const double off = best - composed->lowest[place];
        const double middle = 0.5 * (angle_at(composed, place).value + angle_at(composed, place + 1).value);
        if (!is_wide(composed, place) || !is_at(moving, middle))
            continue;
        left = off > left ? off : left;
        if (off > most && round < EARLY)
            divide_at_minimum(composed, place, values + place * moving->stride, moving->stride, moving->sign);
        else if (off > most)
            divide_evenly(composed, place);
    }
    if (moving->held)
        divide_hidden(composed, moving);
    return left > most ? left : most;
}

/* Divide a step where the shaft stands at an angle, as it seems from the nearer end. */
static void divide_at_edge(struct composed *composed, int64_t place, double angle)
{
    const dual before = angle_at(composed, place), after = angle_at(composed, place + 1);
    const double edge = angle + TURN * floor((0.5 * (before.value + after.value) - angle) / TURN + 0.5);
    const double passed = edge - before.value, ahead = after.value - edge;
    const double start = composed->times[place], end = composed->times[place + 1];
    if (!(passed * ahead > 0.0) || fabs(passed) <= EDGE || fabs(ahead) <= EDGE || !is_wide(composed, place))
        return;
    double time = fabs(passed) < fabs(ahead) ? start + passed / before.tangent : end - ahead / after.tangent;
    if (!(time > start && time < end))
        time = start + (end - start) * (passed / (passed + ahead));
    if (time > start && time < end)
        add(composed, time);
}

/* Divide the steps that may hold the worst value of a question, and at the edges of its windows; whether there are any. */
static bool divide_for(struct composed *composed, int64_t asked, int round)
{
    const int64_t before = composed->more;
    composed->left[asked] = 0.0;
    for (size_t motion = 0; motion < composed->motion_count; motion++) {
        const struct moving *moving = &composed->motions[motion];
        if (moving->asked != asked)
            continue;
        const double off = divide_doubtful(composed, moving, round);
        composed->left[asked] = off > composed->left[asked] ? off : composed->left[asked];
        for (int64_t place = 0; moving->width >= 0.0 && place + 1 < composed->count; place++) {
            divide_at_edge(composed, place, moving->start);
            divide_at_edge(composed, place, moving->start + moving->width);
        }
    }
    return composed->more > before || !composed->complete;
}

/* Divide the steps until the worst values of the unsure questions are found, where there is room. */
static void divide(struct composed *composed)
{
    composed->complete = sample_at(composed, composed->count, composed->times, composed->rows);
    for (int round = 0;; round++) {
        if (composed->express)
            composed->express(composed->count);
        composed->more = 0;
        add(composed, 0.0);
        for (size_t asked = 0; asked < composed->asked_count; asked++)
            composed->unsure[asked] = composed->unsure[asked] && divide_for(composed, (int64_t)asked, round);
        if (composed->more <= 1 || round + 1 == ROUNDS || !composed->complete)
            return;
        composed->more = in_order(composed->new_times, composed->more);
        composed->complete = sample_at(composed, composed->more, composed->new_times, composed->new_rows);
        merge(composed);
    }
}

static void hold_extremes(const struct composed *composed)
{
    const size_t kept = composed->tangents->kept_count;
    for (size_t place = 0; place < composed->latch_count; place++) {
        const struct latch *latch = &composed->latches[place];
        double lowest = INFINITY;
        for (int64_t sample = 0; sample < composed->count; sample++) {
            const double value = latch->sign * composed->rows[(size_t)sample * kept + (size_t)latch->base].value;
            lowest = value < lowest ? value : lowest;
            latch->values[sample] = latch->sign * lowest;
        }
    }
}

/* Place samples that show the worst values of the wanted questions on a run of so many samples, from equal steps on; returns how
 * many there are, 0 where there is no room for the first of them. */
EXPORT int64_t compose(struct composed *composed, int64_t steps, int64_t samples, const char *wanted)
{
    composed->count = first_times(composed, steps, samples);
    memcpy(composed->unsure, wanted, composed->asked_count);
    if (composed->count)
        divide(composed);
    hold_extremes(composed);
    return composed->count;
}
