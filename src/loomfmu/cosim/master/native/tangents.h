/* Steps components with dual numbers, whose variables they share by copies along the wires. */

typedef struct {
    double value;
    double tangent;
} dual;

struct dual_part {
    int64_t (*initialize)(void *, dual);
    int64_t (*step)(void *, dual, dual);
};

struct copy {
    const void *from;
    void *to;
    size_t size;
};

struct stepped {
    const struct dual_part *part;
    void *component;
    const struct copy *copies;
    size_t copy_count;
    size_t placed; /* 1 if it is placed at each time as at a start, and searches nothing on its way there */
};

/* An input that follows a table: its place, and its type as `ctypes` names it: d, q or ?. */
struct driven {
    void *to;
    int64_t type;
};

struct tangents {
    const struct stepped *parts;
    size_t part_count;
    const struct driven *driven;
    size_t driven_count;
    const dual *const *kept;
    size_t kept_count;
};

static void drive(const struct tangents *plan, const double *values)
{
    size_t i;
    for (i = 0; i < plan->driven_count; i++) {
        void *to = plan->driven[i].to;
        switch (plan->driven[i].type) {
        case 'd':
            *(dual *)to = (dual){values[i], 0.0};
            break;
        case 'q':
            *(int64_t *)to = (int64_t)values[i];
            break;
        default:
            *(bool *)to = values[i] > 0.0;
        }
    }
}

/* Fills a row of duals for the start and one for each step. Rows of `driven` are those of the start and of the steps'
 * ends. The plain run made the same steps before, so problems are not reported. */
EXPORT void step_tangents(const struct tangents *plan, int64_t steps, const dual *starts, const dual *sizes,
                          const double *driven, dual *rows)
{
    int64_t step;
    size_t i, j;
    for (step = 0; step <= steps; step++) {
        drive(plan, driven + (size_t)step * plan->driven_count);
        for (i = 0; i < plan->part_count; i++) {
            const struct stepped *part = &plan->parts[i];
            for (j = 0; j < part->copy_count; j++) {
                memcpy(part->copies[j].to, part->copies[j].from, part->copies[j].size);
            }
            if (step == 0) {
                (void)part->part->initialize(part->component, (dual){0.0, steps > 0 ? starts->tangent : 0.0});
            } else if (part->placed) {
                const dual start = starts[step - 1], size = sizes[step - 1];
                (void)part->part->initialize(
                    part->component, (dual){start.value + size.value, start.tangent + size.tangent});
            } else {
                (void)part->part->step(part->component, starts[step - 1], sizes[step - 1]);
            }
        }
        for (i = 0; i < plan->kept_count; i++) {
            *rows++ = *plan->kept[i];
        }
    }
}

/* The slope of rates at a sample, by the parabola through it and its neighbours. */
static double bend(int64_t count, const double *time, const double *rates, int64_t stride, int64_t place)
{
    const int64_t middle = place < 1 ? 1 : place > count - 2 ? count - 2 : place;
    const double *t = time + middle, before = t[0] - t[-1], after = t[1] - t[0], both = before + after;
    const double *r = rates + stride * (middle - 1), r0 = r[0], r1 = r[stride], r2 = r[2 * stride];
    if (place < middle)
        return -(2.0 * before + after) / (before * both) * r0 + both / (before * after) * r1 -
               before / (after * both) * r2;
    if (place > middle)
        return after / (before * both) * r0 - both / (before * after) * r1 +
               (2.0 * after + before) / (after * both) * r2;
    return -after / (before * both) * r0 + (after - before) / (before * after) * r1 + before / (after * both) * r2;
}

static double least(double one, double other) /* NaN if one of them is */
{
    return one < other || isnan(one) ? one : other;
}

/* Finds what a motion, times a sign, does not go below on each step: its cubic, less the share `doubt` of the difference
 * between its second rates and those of the samples of its rates, of which there are three at least. */
static void find_lowest(int64_t count, double doubt, double sign, const double *time, const double *values,
                        const double *rates, int64_t stride, double *lowest)
{
    double bends[2] = {0.0, sign * bend(count, time, rates, stride, 0)};
    for (int64_t place = 0; place + 1 < count; place++, values += stride) {
        const double h = time[place + 1] - time[place], start = sign * values[0], end = sign * values[stride];
        const double first = sign * rates[stride * place] * h, second = sign * rates[stride * (place + 1)] * h;
        const double rise = end - start;
        bends[0] = bends[1];
        bends[1] = sign * bend(count, time, rates, stride, place + 1);
        const double before = fabs(bends[0] * h * h - (6.0 * rise - 4.0 * first - 2.0 * second));
        const double after = fabs(bends[1] * h * h - (2.0 * first + 4.0 * second - 6.0 * rise));
        const double low = least(least(start, start + first / 3.0), least(end - second / 3.0, end));
        lowest[place] = low + doubt * least(-before, -after);
    }
}
