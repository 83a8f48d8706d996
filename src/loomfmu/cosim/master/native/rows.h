/* Runs and judges rows: one run again and again, with other start values. rows.py has the same structs.
 *
 * A row in which anything is out of the ordinary, be it a mere warning, is not clean: Python runs it as any other. */

struct calls {
    const struct call *first;
    size_t count;
};

struct way { /* through a run of some FMUs: their values, their start, a step, their end */
    struct calls prepare, start, step, end;
};

struct setting { /* a number of which each row has its own: a start value, or one that a claim takes */
    void *to;
    int64_t column;
    int64_t whole; /* 1 for an int32_t, 2 for an int64_t */
};

struct shaft { /* one that needs no FMU: the places of its values, and what it turns by */
    int64_t angle, velocity, acceleration;
    double speed, start_angle;
};

struct copied { /* integers that claims take as real numbers */
    int64_t place;
    double *to;
    int64_t boolean;
};

enum { FIELDS = 12 }; /* of a verdict */

struct rows {
    struct way whole, reached; /* all FMUs, and those that the values of a row reach */
    const struct setting *settings;
    size_t setting_count;
    struct shaft *shafts;
    size_t shaft_count;
    const struct copied *copies;
    size_t copy_count;
    const struct asked *asked;
    size_t asked_count;
    const int64_t *angles; /* of which the fastest step counts */
    size_t angle_count;
    const int64_t *const *heard; /* messages of each FMU so far */
    size_t heard_count;
    const int64_t *kept_reals; /* what the others gave in the row before */
    size_t kept_real_count;
    const int64_t *kept_integers;
    size_t kept_integer_count;
    const int64_t *driven_reals;
    size_t driven_real_count;
    const int64_t *driven_integers;
    size_t driven_integer_count;
    double *reals;
    size_t real_count;
    int32_t *integers;
    size_t integer_count;
    struct judges judges;
    struct composed *composed; /* NULL where nothing is judged so */
    int64_t verdicts;
    const int32_t *interrupted;
    double *experiment; /* its start and its end */
    double *starts, *sizes, *times;
    double *driven_real_rows; /* for the start and for each step */
    int32_t *driven_integer_rows;
    double *real_rows;
    int32_t *integer_rows;
    int64_t steps;
    int64_t step_column; /* of the step size; -1 where all rows have the same */
    int64_t warm;        /* what the others give is there */
};

struct found { /* of each row, one after the other */
    char *clean;
    const char *exact; /* of each row, the composed questions to be judged; NULL where all others are */
    double *verdicts, *fastest, *reals;
    int32_t *integers;
    int64_t *notes; /* the place of each note in the texts; -1 for none */
    char *texts;
    int64_t room, used;
};

static bool made(struct calls calls, double start, double size)
{
    for (size_t place = 0; place < calls.count; place++)
        if (perform(&calls.first[place], start, size) != OK)
            return false;
    return true;
}

static int64_t heard(const struct rows *rows)
{
    int64_t count = 0;
    for (size_t place = 0; place < rows->heard_count; place++)
        count += *rows->heard[place];
    return count;
}

/* Equal steps, as grid.py has them. */
static void place_steps(const struct rows *rows, double step)
{
    const double start = rows->experiment[0];
    for (int64_t number = 0; number <= rows->steps; number++)
        rows->times[number] = start + (double)number * step;
    for (int64_t number = 0; number < rows->steps; number++) {
        rows->starts[number] = rows->times[number];
        rows->sizes[number] = step;
    }
    rows->experiment[1] = start + (double)rows->steps * step;
}

static void take_values(const struct rows *rows, const double *values)
{
    for (size_t place = 0; place < rows->setting_count; place++) {
        const struct setting *setting = &rows->settings[place];
        if (setting->whole == 1)
            *(int32_t *)setting->to = (int32_t)values[setting->column];
        else if (setting->whole)
            *(int64_t *)setting->to = (int64_t)values[setting->column];
        else
            *(double *)setting->to = values[setting->column];
    }
    if (rows->step_column >= 0)
        place_steps(rows, values[rows->step_column]);
}

/* The driven inputs at a sample, and there what is kept of the row before. */
static void drive_to(const struct rows *rows, int64_t sample)
{
    const double *reals = rows->driven_real_rows + (size_t)sample * rows->driven_real_count;
    const int32_t *integers = rows->driven_integer_rows + (size_t)sample * rows->driven_integer_count;
    for (size_t place = 0; place < rows->driven_real_count; place++)
        rows->reals[rows->driven_reals[place]] = reals[place];
    for (size_t place = 0; place < rows->driven_integer_count; place++)
        rows->integers[rows->driven_integers[place]] = integers[place];
    for (size_t place = 0; rows->warm && place < rows->kept_real_count; place++) {
        int64_t kept = rows->kept_reals[place];
        rows->reals[kept] = rows->real_rows[(size_t)sample * rows->real_count + (size_t)kept];
    }
    for (size_t place = 0; rows->warm && place < rows->kept_integer_count; place++) {
        int64_t kept = rows->kept_integers[place];
        rows->integers[kept] = rows->integer_rows[(size_t)sample * rows->integer_count + (size_t)kept];
    }
}

static void keep_sample(const struct rows *rows, int64_t sample)
{
    memcpy(rows->real_rows + (size_t)sample * rows->real_count, rows->reals, rows->real_count * sizeof(double));
    memcpy(rows->integer_rows + (size_t)sample * rows->integer_count, rows->integers,
           rows->integer_count * sizeof(int32_t));
}

static void turn_shafts(const struct rows *rows)
{
    for (size_t place = 0; place < rows->shaft_count; place++) {
        const struct shaft *shaft = &rows->shafts[place];
        double *row = rows->real_rows, time = rows->experiment[0];
        for (int64_t sample = 0; sample <= rows->steps; sample++, row += rows->real_count) {
            if (sample > 0)
                time = rows->starts[sample - 1] + rows->sizes[sample - 1];
            row[shaft->angle] = shaft->start_angle + shaft->speed * time;
            row[shaft->velocity] = shaft->speed;
            row[shaft->acceleration] = 0.0;
        }
    }
}

/* Run a row; whether nothing was out of the ordinary. */
static bool run_row(const struct rows *rows, const struct way *way)
{
    memset(rows->reals, 0, rows->real_count * sizeof(double));
    memset(rows->integers, 0, rows->integer_count * sizeof(int32_t));
    if (!made(way->prepare, 0.0, 0.0))
        return false;
    drive_to(rows, 0);
    if (!made(way->start, 0.0, 0.0))
        return false;
    keep_sample(rows, 0);
    for (int64_t step = 0; step < rows->steps; step++) {
        drive_to(rows, step + 1);
        if (!made(way->step, rows->starts[step], rows->sizes[step]))
            return false;
        keep_sample(rows, step + 1);
    }
    turn_shafts(rows);
    double nothing = 0.0; /* NaN with what is not finite */
    for (size_t place = 0; place < (size_t)(rows->steps + 1) * rows->real_count; place++)
        nothing += rows->real_rows[place] - rows->real_rows[place];
    return nothing == 0.0;
}

/* The highest mean speed of each angle in any step. */
static void find_fastest(const struct rows *rows, double *fastest)
{
    for (size_t place = 0; place < rows->angle_count; place++) {
        const double *angle = rows->real_rows + rows->angles[place];
        fastest[place] = 0.0;
        for (int64_t step = 0; step < rows->steps; step++, angle += rows->real_count) {
            double speed = fabs(angle[rows->real_count] - angle[0]) / (rows->times[step + 1] - rows->times[step]);
            if (!(speed <= fastest[place]))
                fastest[place] = speed;
        }
    }
}

static void copy_integers(const struct rows *rows)
{
    for (size_t place = 0; place < rows->copy_count; place++) {
        const struct copied *copied = &rows->copies[place];
        for (int64_t sample = 0; sample <= rows->steps; sample++) {
            int32_t value = rows->integer_rows[(size_t)sample * rows->integer_count + (size_t)copied->place];
            copied->to[sample] = copied->boolean ? (double)(value != 0) : (double)value;
        }
    }
}

/* Keep the note on the last verdict; false where it finds no room. */
static bool keep_note(const struct judges *judges, struct found *found, int64_t verdict)
{
    const char *note = judges->note(judges->run);
    const int64_t length = (int64_t)strlen(note) + 1;
    if (length > found->room - found->used)
        return false;
    found->notes[verdict] = length > 1 ? found->used : -1;
    memcpy(found->texts + found->used, note, (size_t)length);
    found->used += length;
    return true;
}

/* Judge a row on its samples; false where its notes find no room, or the rules no memory. */
static bool judge_row(const struct rows *rows, int64_t row, struct found *found)
{
    const struct judges *judges = &rows->judges;
    copy_integers(rows);
    judges->renew(judges->run, (ptrdiff_t)rows->steps + 1);
    for (size_t place = 0; place < rows->asked_count; place++) {
        const struct asked *asked = &rows->asked[place];
        const int64_t verdict = row * rows->verdicts + asked->number;
        if (!judges->judge(judges->run, asked->list, asked->words, found->verdicts + FIELDS * verdict) ||
            !keep_note(judges, found, verdict))
            return false;
    }
    return true;
}

/* Judge what follows from the time alone; false as above, and where it takes more samples than there is room for. */
static bool compose_row(const struct rows *rows, int64_t row, int64_t steps, struct found *found)
{
    struct composed *composed = rows->composed;
    const struct judges *judges = &composed->judges;
    const char *wanted = found->exact + (size_t)row * composed->asked_count;
    const int64_t count = compose(composed, steps, rows->steps + 1, wanted);
    if (count == 0 || !composed->complete)
        return false;
    judges->renew(judges->run, (ptrdiff_t)count);
    for (size_t place = 0; place < composed->asked_count; place++) {
        const struct asked *asked = &composed->asked[place];
        const int64_t verdict = row * rows->verdicts + asked->number;
        double *numbers = found->verdicts + FIELDS * verdict;
        if (!wanted[place])
            continue;
        if (!judges->judge(judges->run, asked->list, asked->words, numbers) || !keep_note(judges, found, verdict) ||
            !judges->settle(judges->run, asked->list, numbers, 0.0, composed->left[place], composed->share, 0.0))
            return false;
    }
    return true;
}

/* Run and judge rows with their values, but those that `clean` does not ask for. Where a row is not clean, `clean` says so.
 * Returns how many rows were done: all, unless someone wants the end. */
EXPORT int64_t run_rows(struct rows *rows, int64_t count, const double *values, size_t columns, struct found *found)
{
    for (int64_t row = 0; row < count; row++) {
        if (*(const volatile int32_t *)rows->interrupted)
            return row;
        if (!found->clean[row])
            continue;
        const struct way *way = rows->warm ? &rows->reached : &rows->whole;
        const int64_t before = heard(rows);
        take_values(rows, values + (size_t)row * columns);
        bool clean = run_row(rows, way) && heard(rows) == before;
        (void)made(way->end, 0.0, 0.0);
        if (clean) {
            find_fastest(rows, found->fastest + (size_t)row * rows->angle_count);
            const size_t last = (size_t)rows->steps;
            memcpy(found->reals + (size_t)row * rows->real_count, rows->real_rows + last * rows->real_count,
                   rows->real_count * sizeof(double));
            memcpy(found->integers + (size_t)row * rows->integer_count,
                   rows->integer_rows + last * rows->integer_count, rows->integer_count * sizeof(int32_t));
            rows->warm = rows->step_column < 0;
            const double *own = values + (size_t)row * columns;
            clean = found->exact ? compose_row(rows, row, (int64_t)own[rows->composed->count_column], found)
                                 : judge_row(rows, row, found);
        }
        found->clean[row] = clean;
    }
    return count;
}
