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
