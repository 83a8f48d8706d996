/* The messages of an instance, in the words of the live flavour. */

static void fmu_begin(Text *text)
{
    text->length = 0;
    text->text[0] = '\0';
}

static void fmu_add(Text *text, const char *more)
{
    while (*more != '\0' && text->length < TEXT_SIZE - 1) {
        text->text[text->length++] = *more++;
    }
    text->text[text->length] = '\0';
}

/* A host may have set a locale with a decimal comma. */
static void fmu_add_number(Text *text, char *number)
{
    char *comma = strchr(number, ',');
    if (comma != NULL) {
        *comma = '.';
    }
    fmu_add(text, number);
}

/* Seven digits in the unit that people read, as Python's `.7g`; a limit that is none is infinite. */
static void fmu_add_value(Text *text, const Row *row, double value)
{
    char number[32];
    if (value >= DBL_MAX || value <= -DBL_MAX) {
        fmu_add(text, value > 0.0 ? "inf" : "-inf");
    } else if (isnan(value)) {
        fmu_add(text, "nan");
    } else {
        (void)snprintf(number, sizeof number, "%.7g", value / row->factor);
        fmu_add_number(text, number);
    }
}

static void fmu_add_unit(Text *text, const Row *row)
{
    if (strcmp(row->display, "1") != 0) {
        fmu_add(text, " ");
        fmu_add(text, row->display);
    }
}

/* The shortest digits that give the number back, as Python's `repr`. */
static void fmu_add_time(Text *text, double value)
{
    char number[40];
    int digits, exponent;
    if (!isfinite(value)) {
        fmu_add(text, isnan(value) ? "nan" : value > 0.0 ? "inf" : "-inf");
        return;
    }
    for (digits = 1; digits <= 17; digits++) {
        (void)snprintf(number, sizeof number, "%.*e", digits - 1, value);
        if (!(strtod(number, NULL) < value) && !(strtod(number, NULL) > value)) {
            break;
        }
    }
    exponent = atoi(strchr(number, 'e') + 1);
    if (exponent >= -4 && exponent < 16) {
        (void)snprintf(number, sizeof number, "%.*f", digits - exponent > 2 ? digits - 1 - exponent : 1, value);
    }
    fmu_add_number(text, number);
}

/* Logs a message and returns its status. After an error only a reset or a saved state helps. */
static Status fmu_complain(Instance *instance, Status status, const char *message)
{
    if (status == FAILED) {
        instance->state.mode = BROKEN;
    }
    /* an error is always logged, the rest if logging is on */
    if (status == FAILED || (status != OK && instance->logged[status - 1])) {
        fmu_tell(instance, status, categories[status - 1], message);
    }
    return status;
}

/* The same for a message with one name and one number in it. */
static Status fmu_refuse(Instance *instance, const char *format, unsigned long number, const char *name)
{
    char message[256];
    (void)snprintf(message, sizeof message, format, number, name);
    return fmu_complain(instance, FAILED, message);
}

static double fmu_value(const Instance *instance, const Row *row)
{
    const char *place = (const char *)&instance->state.component + row->offset;
    switch (row->kind) {
    case REAL:
        return *(const double *)(const void *)place;
    case INTEGER:
        return (double)*(const int64_t *)(const void *)place;
    case BOOLEAN:
        break;
    }
    return *(const bool *)place ? 1.0 : 0.0;
}

/* The value of the variable that `{name` starts; returns what follows its brace. */
static const char *fmu_add_named(Text *text, const Instance *instance, const char *name)
{
    size_t length = strcspn(name, "}");
    int i;
    for (i = 0; i < VARIABLES; i++) {
        if (strlen(rows[i].name) == length && strncmp(rows[i].name, name, length) == 0) {
            fmu_add_value(text, &rows[i], fmu_value(instance, &rows[i]));
            fmu_add_unit(text, &rows[i]);
        }
    }
    return name[length] == '}' ? name + length + 1 : name + length;
}

/* Logs a problem of the component. A warning is logged once, and the run continues. */
static Status fmu_report(Instance *instance, int64_t number, Status status)
{
    const char *rest;
    Text text;
    if (number < 1 || number > PROBLEMS) {
        return fmu_complain(instance, status, "the component reports an undeclared problem");
    }
    if (problems[number - 1].warning && instance->warned[number - 1]) {
        return OK;
    }
    fmu_begin(&text);
    for (rest = problems[number - 1].text; *rest != '\0';) {
        char letter[2] = {*rest, '\0'};
        if ((*rest == '{' || *rest == '}') && rest[1] == *rest) {
            rest++; /* a brace is doubled */
        } else if (*rest == '{') {
            rest = fmu_add_named(&text, instance, rest + 1);
            continue;
        }
        fmu_add(&text, letter);
        rest++;
    }
    if (problems[number - 1].warning) {
        instance->warned[number - 1] = true;
        (void)fmu_complain(instance, WARNING, text.text);
        return OK;
    }
    return fmu_complain(instance, status, text.text);
}

/* Which messages are logged; all if no category is named. */
static Status fmu_set_logging(Instance *instance, bool on, size_t count, const char *const names[])
{
    Status status = OK;
    size_t i;
    int category;
    for (category = 0; category < CATEGORIES && count == 0; category++) {
        instance->logged[category] = on;
    }
    for (i = 0; i < count; i++) {
        bool known = false;
        for (category = 0; category < CATEGORIES; category++) {
            if (names != NULL && names[i] != NULL && strcmp(names[i], categories[category]) == 0) {
                instance->logged[category] = on;
                known = true;
            }
        }
        if (!known) {
            status = fmu_complain(instance, WARNING, "unknown log category");
        }
    }
    return status;
}
