/* The component of a program over boxes of its inputs, see enclosure.h.
 *
 * The program has declared `component`, its functions, `put` and `got`, and how many OUTPUTS are wanted.
 */
#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

struct begun {
    component self;
    int64_t status;
};

struct outputs {
    enclosure at[OUTPUTS];
};

static bool alike(const begun &a, const begun &b)
{
    return a.status == b.status && alike(a.self, b.self);
}

static void join(begun &a, const begun &b)
{
    join(a.self, b.self);
}

static bool alike(const outputs &, const outputs &)
{
    return true; /* all of them are numbers */
}

static void join(outputs &a, const outputs &b)
{
    join(a.at, b.at);
}

static enclosure read(const double *row)
{
    enclosure made({row[0], row[1]}, ++serial, false);
    for (int i = 0; i < box_size; i++) {
        made.slope[i] = {row[2 + 2 * i], row[3 + 2 * i]};
        made.varies |= !(row[2 + 2 * i] == 0.0 && row[3 + 2 * i] == 0.0);
    }
    if (row[0] == row[1] && !made.varies) {
        made.serial = 0;
    }
    return made;
}

static bool harmless(int64_t status, int64_t count, const int32_t *warnings)
{
    bool found = status == 0;
    for (int64_t i = 0; i < count; i++) {
        found |= status == warnings[i];
    }
    return found;
}

/* The component, given some inputs, at the start of a run, or at once another sample of it. */
static begun started(begun before, bool again, int64_t given, const int32_t *to, const double *inputs)
{
    enclosure time = unknown(); /* unless it is given */
    if (!again) {
        component_start(&before.self);
    }
    for (int64_t i = 0; i < given; i++) {
        put(&before.self, &time, to[i], read(inputs + i * (2 + 2 * box_size)));
    }
    before.status = again ? component_step(&before.self, time, enclosure(0.0)) : component_initialize(&before.self, time);
    return before;
}

/* The component in each of `rows` boxes: bounds of the values and slopes of some outputs, from those of its inputs.
 *
 * The first `fixed` inputs of each row are those of all rows; with `once` the component is initialized with these
 * alone, which needs outputs that depend on nothing before. Where it may report a problem, nothing is known.
 */
extern "C" EXPORT void enclose(int64_t rows, int64_t size, int64_t fixed, int64_t given, const int32_t *to,
                               const double *inputs, int64_t wanted, const int32_t *from, double *results,
                               int64_t once, int64_t count, const int32_t *warnings)
{
    const int64_t width = 2 + 2 * size;
    static begun first;
    volatile bool begins_once = false; /* where it can begin without the other inputs */
    box_size = (int)size;
    if (once && !setjmp(given_up)) {
        present = nullptr;
        first = joined<begun>([=]() { return started(begun{}, false, fixed, to, inputs); });
        begins_once = harmless(first.status, count, warnings);
    }
    for (volatile int64_t row = 0; row < rows; row = row + 1) {
        double *result = results + row * wanted * width;
        for (int64_t i = 0; i < wanted * width; i++) {
            result[i] = i % 2 ? INFINITY : -INFINITY;
        }
        serial = fresh += UINT64_C(1) << 28; /* no value of this row is one of another */
        if (setjmp(given_up)) {
            continue;
        }
        present = nullptr;
        const bool again = begins_once;
        const int64_t skipped = again ? fixed : 0;
        const double *own = inputs + (row * given + skipped) * width;
        const outputs found = joined<outputs>([=]() {
            const begun made = started(again ? first : begun{}, again, given - skipped, to + skipped, own);
            outputs shown;
            if (!harmless(made.status, count, warnings)) {
                give_up();
            }
            for (int i = 0; i < OUTPUTS; i++) {
                shown.at[i] = got(&made.self, from[i]);
            }
            return shown;
        });
        for (int64_t i = 0; i < wanted; i++) {
            const enclosure &one = found.at[i];
            double *here = result + i * width;
            here[0] = one.value.low;
            here[1] = one.value.high;
            for (int64_t j = 0; j < size; j++) {
                here[2 + 2 * j] = one.varies ? one.slope[j].low : 0.0;
                here[3 + 2 * j] = one.varies ? one.slope[j].high : 0.0;
            }
        }
    }
}
