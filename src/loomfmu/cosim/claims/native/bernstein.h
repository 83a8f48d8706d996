/* Polynomials by their Bernstein points.
 *
 * A polynomial stays between the lowest and the highest of its points and begins and ends at the outer ones. Cut in half, the
 * points come closer to it by a factor of four: so its extremes and its zeros are found for any degree, and none is missed. */

enum { MOST = 6 };                       /* points: those of a quintic */
enum { HALVINGS = 60 };                  /* more than doubles can tell apart */
static const double NARROWEST = 0x1p-60; /* the share of a piece that is left after them */
static const double NOISE = 4.0 * 0x1p-52;

/* The pieces before and after a share of the way, by de Casteljau's scheme. Either may be the piece itself. */
static void split(const double *points, size_t count, double share, double *left, double *right)
{
    double row[MOST];
    memcpy(row, points, count * sizeof *row);
    for (size_t order = 0; order < count; order++) {
        if (left != NULL)
            left[order] = row[0];
        for (size_t place = 0; place + order + 1 < count; place++)
            row[place] = row[place] + share * (row[place + 1] - row[place]);
    } /* the right half stays in the row */
    if (right != NULL)
        memcpy(right, row, count * sizeof *row);
}

static double value(const double *points, size_t count, double share)
{
    double after[MOST];
    split(points, count, share, NULL, after);
    return after[0];
}

/* The part between two shares of the way; a whole piece stays as it is, to the last bit. */
static void clip(double *points, size_t count, double low, double high)
{
    if (low > 0.0 || high < 1.0) {
        double before[MOST];
        split(points, count, high, before, NULL);
        split(before, count, low / high, NULL, points);
    }
}

/* Points of a cubic or quintic with a bump on it, `16 s^2 (1 - s)^2` times its height, and their number: what an unknown
 * rate of change of the rates may add. It leaves values and rates at the ends. */
static size_t raise(const double *points, size_t count, double height, double *raised)
{
    memcpy(raised, points, count * sizeof *raised);
    if (count == MOST) {
        raised[2] = points[2] + 1.6 * height;
        raised[3] = points[3] + 1.6 * height;
        return MOST;
    }
    raised[1] = 0.25 * (points[0] + 3.0 * points[1]);
    raised[2] = 0.5 * (points[1] + points[2]) + 16.0 / 6.0 * height;
    raised[3] = 0.25 * (3.0 * points[2] + points[3]);
    raised[4] = points[3];
    return 5;
}

static double least_point(const double *points, size_t count)
{
    double least = points[0];
    for (size_t place = 1; place < count; place++)
        least = points[place] < least ? points[place] : least;
    return least;
}

struct half { /* a part of a piece, and the share of the way at which it begins */
    double points[MOST], begin;
};

enum { FEW = 16 }; /* parts that take no memory of their own */

/* The parts that may reach below a value, cut in half: all left ones, then all right ones. Returns their number. */
static ptrdiff_t cut(struct run *run, struct half **parts, ptrdiff_t parts_count, size_t count, double below, double width,
                     struct half *few)
{
    ptrdiff_t lower = 0, made = 0;
    for (ptrdiff_t place = 0; place < parts_count; place++)
        lower += least_point((*parts)[place].points, count) < below;
    struct half *found = 2 * lower <= FEW ? few : take(run, &run->scratch, 2 * (size_t)lower * sizeof *found);
    for (ptrdiff_t place = 0; place < parts_count && made < lower; place++) {
        const struct half *part = &(*parts)[place];
        if (least_point(part->points, count) < below) {
            struct half *left = &found[made], *right = &found[lower + made++];
            split(part->points, count, 0.5, left->points, right->points);
            left->begin = part->begin;
            right->begin = part->begin + width;
        }
    }
    *parts = found;
    return 2 * lower;
}

/* Lowest value of a piece, and the share of the way at which it is. */
static double lowest_of(struct run *run, const double *points, size_t count, double *share)
{
    double first = points[0], end = points[count - 1], best = first < end ? first : end, noise = 0.0, width = 1.0;
    struct half few[2][FEW], *parts = few[1];
    ptrdiff_t parts_count = 1;
    *share = end < first ? 1.0 : 0.0;
    for (size_t place = 0; place < count; place++)
        noise = fabs(points[place]) > noise ? fabs(points[place]) : noise;
    noise *= NOISE;
    memcpy(parts[0].points, points, count * sizeof *points);
    parts[0].begin = 0.0;
    for (int round = 0; round < HALVINGS && parts_count > 0; round++) {
        width *= 0.5;
        parts_count = cut(run, &parts, parts_count, count, best - noise, width, few[round % 2]);
        const double before = best;
        for (ptrdiff_t place = parts_count / 2; place < parts_count; place++) /* of equal ones the last */
            if (parts[place].points[0] < before && parts[place].points[0] <= best) {
                best = parts[place].points[0];
                *share = parts[place].begin;
            }
    }
    return best;
}

/* Where a polynomial that changes its sign once does so: halved until nothing is left between. */
static double sign_change(const double *points, size_t count)
{
    const bool begins_negative = points[0] < 0.0;
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

/* Shares of the way at which one piece changes its sign, in order; 0 counts as positive. */
static void sign_changes(struct run *run, const double *points, size_t count, double begin, double width,
                         struct times *shares)
{
    int changes = 0;
    for (size_t place = 1; place < count; place++)
        changes += (points[place - 1] < 0.0) != (points[place] < 0.0);
    if (changes == 1)
        add_time(run, shares, begin + width * sign_change(points, count));
    if (changes <= 1)
        return;
    if (width < NARROWEST) {
        if ((points[0] < 0.0) != (points[count - 1] < 0.0))
            add_time(run, shares, begin);
        return;
    }
    double left[MOST], right[MOST];
    split(points, count, 0.5, left, right);
    sign_changes(run, left, count, begin, 0.5 * width, shares);
    sign_changes(run, right, count, begin + 0.5 * width, 0.5 * width, shares);
}
