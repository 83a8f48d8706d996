/* The host of fuzz.c for FMI 3: random calls to both interfaces, and random bytes for states. */
#include "fmi3.c"

#include "fuzz.h"

#define INSTANCES 4

static long solved;

static void logger(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category,
                   fmi3String message)
{
    (void)environment;
    if (category == NULL || message == NULL || message[0] == '\0' || status == fmi3OK || status > fmi3Error) {
        abort();
    }
}

static void values(fmi3Instance instance)
{
    unsigned references[5], function = pick(8);
    double reals[5];
    int64_t integers[5];
    bool booleans[5];
    const char *texts[5] = {"", "", "", "", ""};
    size_t i, count = pick(5), given = pick(50) ? count : pick(6);
    Kind kind = function % 4 == 0 ? REAL : function % 4 == 1 ? INTEGER : BOOLEAN;
    for (i = 0; i < 5; i++) {
        references[i] = any_reference(kind, function < 4);
        reals[i] = fitting_real(references[i]);
        integers[i] = pick(20) ? python_whole(fitting_real(references[i])) : pick(2) ? INT64_MIN : INT64_MAX;
        booleans[i] = pick(2) != 0;
    }
    switch (function) {
    case 0: (void)fmi3SetFloat64(instance, references, count, pick(60) ? reals : NULL, given); break;
    case 1: (void)fmi3SetInt64(instance, references, count, integers, given); break;
    case 2: (void)fmi3SetBoolean(instance, references, count, booleans, given); break;
    case 3: (void)(pick(20) ? fmi3OK : fmi3SetString(instance, references, count, texts, given)); break;
    case 4: (void)fmi3GetFloat64(instance, pick(60) ? references : NULL, count, reals, given); break;
    case 5: (void)fmi3GetInt64(instance, references, count, integers, given); break;
    case 6: (void)fmi3GetBoolean(instance, references, count, booleans, given); break;
    default: (void)(pick(20) ? fmi3OK : fmi3GetUInt8(instance, NULL, count, NULL, given)); break;
    }
}

static void bytes(fmi3Instance instance, fmi3FMUState *saved)
{
    uint8_t content[ROOM];
    size_t size = any_bytes(content);
    if (*saved != NULL && pick(3) != 0 && fmi3SerializeFMUState(instance, *saved, content, size) == fmi3OK) {
        damage(content);
    }
    count_bytes(fmi3DeserializeFMUState(instance, pick(60) ? content : NULL, size, saved) == fmi3OK);
}

static void states(fmi3Instance instance, fmi3FMUState *saved)
{
    size_t size;
    switch (pick(6)) {
    case 0: (void)fmi3GetFMUState(instance, pick(60) ? saved : NULL); break;
    case 1: restored += fmi3SetFMUState(instance, *saved) == fmi3OK; break;
    case 2: (void)fmi3FreeFMUState(instance, pick(60) ? saved : NULL); break;
    case 3: (void)fmi3SerializedFMUStateSize(instance, *saved, pick(60) ? &size : NULL); break;
    default: bytes(instance, saved); break;
    }
}

static void step(fmi3Instance instance)
{
    double time = pick(10) ? (double)pick(1000) * 1e-3 : any_real(), reached;
    double size = pick(10) ? (double)pick(1000) * 1e-5 : any_real();
    bool flags[3];
    if (size > 1e3 && pick(50) != 0) {
        size = 1e-3; /* a damper takes its time over an hour */
    }
    stepped += fmi3DoStep(instance, time, size, pick(2) != 0, &flags[0], &flags[1], &flags[2],
                          pick(60) ? &reached : NULL) == fmi3OK;
}

static void solve(fmi3Instance instance)
{
    bool flags[5];
    double next;
    size_t count = pick(10) == 0;
    double indicators_now[INDICATORS + 1];
    switch (pick(14)) {
    case 0: (void)fmi3EnterEventMode(instance); break;
    case 1:
        (void)fmi3UpdateDiscreteStates(instance, &flags[0], &flags[1], &flags[2], &flags[3], &flags[4],
                                       pick(60) ? &next : NULL);
        break;
    case 2: (void)fmi3EnterContinuousTimeMode(instance); break;
    case 3: (void)fmi3CompletedIntegratorStep(instance, true, &flags[0], pick(60) ? &flags[1] : NULL); break;
    case 4: (void)fmi3GetContinuousStates(instance, &next, count); break;
    case 5: (void)fmi3GetNumberOfEventIndicators(instance, pick(60) ? &count : NULL); break;
    case 6: (void)fmi3GetNumberOfContinuousStates(instance, pick(60) ? &count : NULL); break;
    case 7: (void)fmi3GetContinuousStateDerivatives(instance, &next, count); break;
    case 8: (void)fmi3GetNominalsOfContinuousStates(instance, &next, count); break;
    case 9: (void)fmi3SetContinuousStates(instance, &next, count); break;
    case 10:
        (void)fmi3GetEventIndicators(instance, pick(60) ? indicators_now : NULL,
                                     pick(40) ? INDICATORS : pick(INDICATORS + 3));
        break;
    default:
        solved += fmi3SetTime(instance, pick(10) ? (double)pick(1000) * 1e-3 : any_real()) == fmi3OK;
        break;
    }
}

static void start(fmi3Instance instance)
{
    (void)fmi3Reset(instance);
    (void)fmi3EnterInitializationMode(instance, false, 0.0, 0.0, false, 0.0);
    (void)fmi3ExitInitializationMode(instance);
    if (((Instance *)instance)->state.mode == EVENTS) {
        (void)fmi3EnterContinuousTimeMode(instance);
    }
}

/* Reading and setting variables of a type that no component has. */
#define ABSENT(TYPE)                                                                                       \
    static void absent_##TYPE(fmi3Instance instance, const unsigned references[], size_t count)            \
    {                                                                                                      \
        fmi3##TYPE content[4] = {0};                                                                       \
        if (pick(2)) {                                                                                     \
            (void)fmi3Get##TYPE(instance, references, count, content, count);                              \
        } else {                                                                                           \
            (void)fmi3Set##TYPE(instance, references, count, content, count);                              \
        }                                                                                                  \
    }

ABSENT(Float32)
ABSENT(Int8)
ABSENT(UInt8)
ABSENT(Int16)
ABSENT(UInt16)
ABSENT(Int32)
ABSENT(UInt32)
ABSENT(UInt64)
ABSENT(String)

static void clocks(fmi3Instance instance, const unsigned references[], size_t count)
{
    bool ticks[4] = {false};
    double times[4] = {0.0};
    uint64_t counters[4] = {0}, resolutions[4] = {0};
    fmi3IntervalQualifier qualifiers[4];
    switch (pick(10)) {
    case 0: (void)fmi3GetClock(instance, references, count, ticks); break;
    case 1: (void)fmi3SetClock(instance, references, count, ticks); break;
    case 2: (void)fmi3GetIntervalDecimal(instance, references, count, times, qualifiers); break;
    case 3:
        (void)fmi3GetIntervalFraction(instance, references, count, counters, resolutions, qualifiers);
        break;
    case 4: (void)fmi3GetShiftDecimal(instance, references, count, times); break;
    case 5: (void)fmi3GetShiftFraction(instance, references, count, counters, resolutions); break;
    case 6: (void)fmi3SetIntervalDecimal(instance, references, count, times); break;
    case 7: (void)fmi3SetIntervalFraction(instance, references, count, counters, resolutions); break;
    case 8: (void)fmi3SetShiftDecimal(instance, references, count, times); break;
    default: (void)fmi3SetShiftFraction(instance, references, count, counters, resolutions); break;
    }
}

/* What no component has: it is refused, whatever is given. */
static void absent(fmi3Instance instance)
{
    static void (*const types[])(fmi3Instance, const unsigned *, size_t) = {
        absent_Float32, absent_Int8,   absent_UInt8,  absent_Int16,  absent_UInt16,
        absent_Int32,   absent_UInt32, absent_UInt64, absent_String, clocks,
    };
    unsigned references[4];
    size_t i, sizes[4] = {0}, count = pick(40) ? 0 : pick(5);
    const uint8_t *binaries[4] = {NULL};
    double values[4] = {0.0};
    for (i = 0; i < 4; i++) {
        references[i] = any_reference(REAL, false);
    }
    if (pick(4)) {
        types[pick(10)](instance, pick(20) ? references : NULL, count);
        return;
    }
    switch (pick(80)) {
    case 0: (void)fmi3EvaluateDiscreteStates(instance); break;
    case 1: (void)fmi3GetNumberOfVariableDependencies(instance, references[0], sizes); break;
    case 2:
        (void)fmi3GetVariableDependencies(instance, references[0], sizes, references, sizes, NULL, 1);
        break;
    case 3:
        (void)fmi3GetDirectionalDerivative(instance, references, 1, references, 1, values, 1, values, 1);
        break;
    case 4:
        (void)fmi3GetAdjointDerivative(instance, references, 1, references, 1, values, 1, values, 1);
        break;
    case 5: (void)fmi3EnterConfigurationMode(instance); break;
    case 6: (void)fmi3ExitConfigurationMode(instance); break;
    case 7: (void)fmi3ActivateModelPartition(instance, references[0], any_real()); break;
    case 8: (void)fmi3EnterStepMode(instance); break;
    case 9: (void)fmi3SetBinary(instance, references, count, sizes, binaries, count); break;
    default: (void)fmi3GetBinary(instance, references, 0, sizes, binaries, 0); break;
    }
}

static void derivatives(fmi3Instance instance)
{
    unsigned references[4];
    int32_t orders[4];
    double values[4];
    size_t i, count = pick(5);
    for (i = 0; i < 4; i++) {
        references[i] = any_reference(REAL, false);
        orders[i] = pick(20) ? (int32_t)pick(3) + 1 : pick(2) ? INT32_MIN : (int32_t)pick(100) - 50;
    }
    (void)fmi3GetOutputDerivatives(instance, references, count, pick(60) ? orders : NULL, values,
                                   pick(60) ? count : pick(5));
}

static void life(fmi3Instance instance)
{
    const char *names[] = {"logStatusWarning", "logStatusError", "none", NULL};
    const char *chosen[2];
    chosen[0] = names[pick(4)];
    chosen[1] = names[pick(4)];
    switch (pick(8)) {
    case 0: (void)fmi3SetDebugLogging(instance, pick(2) != 0, pick(3), pick(20) ? chosen : NULL); break;
    case 1:
        (void)fmi3EnterInitializationMode(instance, false, 0.0, any_real(), pick(3) == 0, any_real());
        break;
    case 2: (void)fmi3ExitInitializationMode(instance); break;
    case 3: (void)(pick(8) ? fmi3OK : fmi3Terminate(instance)); break;
    case 4: absent(instance); break;
    case 5: derivatives(instance); break;
    default: (void)(pick(4) ? fmi3OK : fmi3Reset(instance)); break;
    }
}

static void call(fmi3Instance *instance, fmi3FMUState *saved)
{
    const char *token = pick(20) ? MODEL_TOKEN : pick(2) ? "another" : NULL;
    const char *name = pick(20) ? "fuzz %s%n" : pick(2) ? NULL : " ";
    if (*instance == NULL) {
        if (pick(50) == 0) {
            *instance = fmi3InstantiateScheduledExecution(name, token, NULL, false, pick(2) != 0, NULL, logger,
                                                          NULL, NULL, NULL);
        } else if (pick(2)) {
            *instance = fmi3InstantiateCoSimulation(name, token, NULL, false, pick(2) != 0, pick(20) == 0, false,
                                                    NULL, 0, NULL, pick(20) ? logger : NULL, NULL);
        } else {
            *instance = fmi3InstantiateModelExchange(name, token, NULL, false, pick(2) != 0, NULL, logger);
        }
        return;
    }
    if (((Instance *)*instance)->state.mode == BROKEN && pick(3) == 0) {
        start(*instance);
        return;
    }
    switch (pick(16)) {
    case 0: states(*instance, saved); break;
    case 1: bytes(*instance, saved); break;
    case 2: life(*instance); break;
    case 3: start(*instance); break;
    case 4:
        if (pick(30) == 0) {
            fmi3FreeInstance(*instance);
            *instance = NULL;
        }
        break;
    case 5:
    case 6:
    case 7:
    case 8:
    case 9:
        if (((Instance *)*instance)->host.model_exchange != (pick(40) == 0)) {
            solve(*instance);
        } else {
            step(*instance);
        }
        break;
    default: values(*instance); break;
    }
}

/* fuzz3 SEED CALLS: prints how far it got; the sanitizers see what is left behind */
int main(int count, char **words)
{
    fmi3Instance instances[INSTANCES] = {NULL};
    fmi3FMUState saved[SAVED] = {NULL};
    fmi3Instance last;
    long calls;
    int i;
    seed = count > 1 ? strtoull(words[1], NULL, 10) : 1;
    for (calls = count > 2 ? atol(words[2]) : 1000; calls > 0; calls--) {
        call(&instances[pick(INSTANCES)], &saved[pick(SAVED)]);
    }
    last = fmi3InstantiateCoSimulation("last", MODEL_TOKEN, NULL, false, false, false, false, NULL, 0, NULL,
                                       NULL, NULL);
    for (i = 0; i < SAVED; i++) {
        if (fmi3FreeFMUState(last, &saved[i]) != fmi3OK) {
            return 2;
        }
    }
    for (i = 0; i < INSTANCES; i++) {
        fmi3FreeInstance(instances[i]);
    }
    fmi3FreeInstance(last);
    printf("%ld %ld %ld %ld\n", stepped, solved + restored, unpacked, refused);
    return 0;
}
