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

struct moving { /* of a question: a signal, or what holds its lowest values times a sign */
    int64_t asked, base, held;
    double sign;
    int64_t recorded; /* where a run has it among its reals */
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
    const struct asked *asked;
    size_t asked_count;
    const struct tangents *tangents;
    struct judges judges;
    double *times, *new_times, *merged_times; /* of samples, for as many as there is room */
    dual *rows, *new_rows, *merged_rows, *starts, *sizes;
    double *lowest, *left;
    char *doubtful, *own, *inside, *may_be;
    int64_t room, count_column, parts, rounds;
    double doubt, narrow, exact, rounded, share; /* see composed.py */
};

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

/* Add a time in order, each once. */
static int64_t with_time(double *times, int64_t count, double time)
{
    int64_t place = count;
    while (place > 0 && times[place - 1] > time)
        place--;
    if (place > 0 && times[place - 1] == time)
        return count;
    memmove(times + place + 1, times + place, (size_t)(count - place) * sizeof *times);
    times[place] = time;
    return count + 1;
}

/* Take samples in, except at times that are known. */
static int64_t merge(const struct composed *composed, int64_t count, int64_t more)
{
    const size_t kept = composed->tangents->kept_count, size = kept * sizeof(dual);
    int64_t merged = 0, old = 0, new = 0;
    while (old < count || new < more) {
        const bool known = old < count && (new == more || composed->times[old] <= composed->new_times[new]);
        const double time = known ? composed->times[old] : composed->new_times[new];
        const dual *row = known ? composed->rows + (size_t)old * kept : composed->new_rows + (size_t)new * kept;
        memcpy(composed->merged_rows + (size_t)merged * kept, row, size);
        composed->merged_times[merged++] = time;
        old += known;
        while (new < more && composed->new_times[new] == time)
            new++;
    }
    memcpy(composed->times, composed->merged_times, (size_t)merged * sizeof(double));
    memcpy(composed->rows, composed->merged_rows, (size_t)merged * size);
    return merged;
}

/* Equal steps, and the worst samples of the run: their number, 0 where there is no room. */
static int64_t first_times(const struct composed *composed, int64_t steps, int64_t samples, const double *times,
                           const double *reals, size_t real_count)
{
    const double end = times[samples - 1], step = end / (double)steps;
    int64_t count = steps + 1;
    if (count + (int64_t)composed->motion_count > composed->room)
        return 0;
    for (int64_t place = 0; place < steps; place++)
        composed->times[place] = (double)place * step;
    composed->times[steps] = end;
    for (size_t place = 0; place < composed->motion_count; place++) {
        const struct moving *moving = &composed->motions[place];
        int64_t worst = 0;
        for (int64_t sample = 1; sample < samples; sample++)
            if (moving->sign * reals[(size_t)sample * real_count + (size_t)moving->recorded] <
                moving->sign * reals[(size_t)worst * real_count + (size_t)moving->recorded])
                worst = sample;
        count = with_time(composed->times, count, times[worst]);
    }
    return count;
}

/* What a signal times a sign does not go below on each step. */
static void lowest_of(const struct composed *composed, int64_t count, int64_t signal, double sign)
{
    const size_t kept = composed->tangents->kept_count;
    const dual *first = composed->rows + signal;
    find_lowest(count, composed->doubt, sign, composed->times, &first->value, &first->tangent, (int64_t)(2 * kept),
                composed->lowest);
}

/* Mark the steps within which alone a signal may be where its extremes lie. */
static void mark_hidden(const struct composed *composed, int64_t count, const struct moving *moving)
{
    const size_t kept = composed->tangents->kept_count;
    memset(composed->inside, 1, (size_t)count);
    memset(composed->may_be, 1, (size_t)count);
    for (size_t window = 0; window < moving->window_count; window++) {
        const int64_t signal = moving->windows[window];
        lowest_of(composed, count, signal, -1.0);
        for (int64_t place = 0; place < count; place++)
            composed->inside[place] &= composed->rows[(size_t)place * kept + (size_t)signal].value > 0.0;
        for (int64_t place = 0; place + 1 < count; place++)
            composed->may_be[place] &= -composed->lowest[place] > 0.0;
    }
    for (int64_t place = 0; moving->window_count > 0 && place + 1 < count; place++)
        composed->own[place] |= composed->may_be[place] && !composed->inside[place] && !composed->inside[place + 1];
}

static bool is_wide(const struct composed *composed, int64_t count, int64_t place)
{
    return composed->times[place + 1] - composed->times[place] > composed->narrow * composed->times[count - 1];
}

/* Mark the steps that may hold the worst value of a motion; returns how far that may be off. */
static double mark_doubtful(const struct composed *composed, int64_t count, const struct moving *moving)
{
    const size_t kept = composed->tangents->kept_count;
    const dual *row = composed->rows + moving->base;
    double best = INFINITY, largest = 0.0, left = 0.0;
    for (int64_t place = 0; place < count; place++, row += kept) {
        best = moving->sign * row->value < best ? moving->sign * row->value : best;
        largest = fabs(row->value) > largest ? fabs(row->value) : largest;
    }
    lowest_of(composed, count, moving->base, moving->sign);
    const double most = composed->exact * fabs(best) + composed->rounded * largest;
    for (int64_t place = 0; place + 1 < count; place++) {
        const double off = best - composed->lowest[place];
        if (off > left && is_wide(composed, count, place))
            left = off;
        composed->own[place] |= off > most;
    }
    if (moving->held)
        mark_hidden(composed, count, moving);
    return left > most ? left : most;
}

/* Mark the steps that may hold the worst value of a question; returns how many. */
static int64_t doubtful_of(const struct composed *composed, int64_t count, int64_t asked)
{
    int64_t marked = 0;
    memset(composed->own, 0, (size_t)count);
    composed->left[asked] = 0.0;
    for (size_t place = 0; place < composed->motion_count; place++) {
        if (composed->motions[place].asked != asked)
            continue;
        const double off = mark_doubtful(composed, count, &composed->motions[place]);
        composed->left[asked] = off > composed->left[asked] ? off : composed->left[asked];
    }
    for (int64_t place = 0; place + 1 < count; place++) {
        composed->own[place] &= is_wide(composed, count, place);
        composed->doubtful[place] |= composed->own[place];
        marked += composed->own[place];
    }
    return marked;
}

/* The times that divide the marked steps, after 0: their number, 0 where there is no room. */
static int64_t divided(const struct composed *composed, int64_t count)
{
    int64_t more = 1;
    composed->new_times[0] = 0.0;
    for (int64_t place = 0; place + 1 < count; place++) {
        const double start = composed->times[place], size = composed->times[place + 1] - start;
        if (composed->doubtful[place] && count + more + composed->parts > composed->room)
            return 0;
        for (int64_t part = 1; composed->doubtful[place] && part < composed->parts; part++)
            composed->new_times[more++] = start + size * ((double)part / (double)composed->parts);
    }
    return more;
}

/* Divide the steps until the worst values of the wanted questions are found; returns the number of samples, 0 if that fails. */
static int64_t divide(const struct composed *composed, int64_t count, const char *wanted)
{
    uint64_t unsure = 0;
    for (size_t asked = 0; asked < composed->asked_count; asked++)
        unsure |= (uint64_t)(wanted[asked] != 0) << asked;
    if (count == 0 || !sample_at(composed, count, composed->times, composed->rows))
        return 0;
    for (int64_t round = 0;; round++) {
        memset(composed->doubtful, 0, (size_t)count);
        for (size_t asked = 0; asked < composed->asked_count; asked++)
            if (unsure >> asked & 1 && doubtful_of(composed, count, (int64_t)asked) == 0)
                unsure &= ~((uint64_t)1 << asked);
        if (unsure == 0 || round + 1 == composed->rounds)
            return count;
        const int64_t more = divided(composed, count);
        if (more == 0 || !sample_at(composed, more, composed->new_times, composed->new_rows))
            return 0;
        count = merge(composed, count, more);
    }
}

static void hold_extremes(const struct composed *composed, int64_t count)
{
    const size_t kept = composed->tangents->kept_count;
    for (size_t place = 0; place < composed->latch_count; place++) {
        const struct latch *latch = &composed->latches[place];
        double lowest = INFINITY;
        for (int64_t sample = 0; sample < count; sample++) {
            const double value = latch->sign * composed->rows[(size_t)sample * kept + (size_t)latch->base].value;
            lowest = value < lowest ? value : lowest;
            latch->values[sample] = latch->sign * lowest;
        }
    }
}
