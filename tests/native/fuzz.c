/* A host that keeps no rules: random calls with random arguments, and random bytes for states.
 *
 * Built with the address and undefined-behaviour sanitizers, which end it at the first misdeed of the FMU.
 */
#include "fmi2.c"

#include "fuzz.h"

#define INSTANCES 3

static long living;
static int starving;

static void *allocate(size_t count, size_t size)
{
    if (starving && pick(3) == 0) {
        return NULL;
    }
    living++;
    return calloc(count, size);
}

static void release(void *memory)
{
    living -= memory != NULL;
    free(memory);
}

static void logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                   fmi2String category, fmi2String message, ...)
{
    char text[5000];
    (void)environment;
    if (name == NULL || category == NULL || status > fmi2Error || status == fmi2OK) {
        abort();
    }
    if (snprintf(text, sizeof text, message, "", "", "") < 1) {
        abort();
    }
}

static int any_integer(void)
{
    static const int odd[] = {0, 1, -1, 2, 3, 2147483647, -2147483647 - 1};
    return pick(3) == 0 ? odd[pick(7)] : (int)pick(200) - 40;
}

static const char *any_token(void)
{
    return pick(20) == 0 ? (pick(2) ? NULL : "another") : MODEL_TOKEN;
}

static void values(fmi2Component component)
{
    unsigned references[5];
    double reals[5];
    int integers[5];
    const char *texts[5] = {"", "", "", "", ""};
    size_t i, count = pick(6);
    unsigned function = pick(8);
    Kind kind = function % 4 == 0 ? REAL : function % 4 == 1 ? INTEGER : BOOLEAN;
    const unsigned *given = pick(60) == 0 ? NULL : references;
    for (i = 0; i < count && i < 5; i++) {
        references[i] = any_reference(kind, function < 4);
        reals[i] = fitting_real(references[i]);
        integers[i] = pick(4) ? (int)(python_whole(fitting_real(references[i])) % 1000) : any_integer();
    }
    count = count > 5 ? 5 : count;
    switch (function) {
    case 0: (void)fmi2SetReal(component, given, count, reals); break;
    case 1: (void)fmi2SetInteger(component, given, count, integers); break;
    case 2: (void)fmi2SetBoolean(component, given, count, integers); break;
    case 3: (void)fmi2SetString(component, given, count, texts); break;
    case 4: (void)fmi2GetReal(component, given, count, reals); break;
    case 5: (void)fmi2GetInteger(component, given, count, integers); break;
    case 6: (void)fmi2GetBoolean(component, given, count, integers); break;
    default: (void)fmi2GetString(component, given, count, texts); break;
    }
}

static void derivatives(fmi2Component component)
{
    unsigned references[4];
    int orders[4];
    double reals[4];
    size_t i, count = pick(5);
    for (i = 0; i < count; i++) {
        references[i] = any_reference(REAL, true);
        orders[i] = pick(20) == 0 ? any_integer() : (int)pick(3) + 1;
        reals[i] = any_real();
    }
    if (pick(2) == 0) {
        (void)fmi2SetRealInputDerivatives(component, references, count, pick(50) ? orders : NULL, reals);
    } else {
        (void)fmi2GetRealOutputDerivatives(component, references, count, pick(50) ? orders : NULL, reals);
    }
}

static void bytes(fmi2Component component, fmi2FMUstate *saved)
{
    char content[ROOM];
    size_t size = any_bytes((unsigned char *)content);
    if (*saved != NULL && pick(3) != 0 && fmi2SerializeFMUstate(component, *saved, content, size) == fmi2OK) {
        damage((unsigned char *)content);
    }
    count_bytes(fmi2DeSerializeFMUstate(component, pick(60) ? content : NULL, size, saved) == fmi2OK);
}

static void states(fmi2Component component, fmi2FMUstate *saved)
{
    fmi2FMUstate none = NULL;
    size_t size;
    switch (pick(8)) {
    case 0: (void)fmi2GetFMUstate(component, pick(60) ? saved : NULL); break;
    case 1: restored += fmi2SetFMUstate(component, *saved) == fmi2OK; break;
    case 2: (void)fmi2FreeFMUstate(component, pick(60) ? saved : NULL); break;
    case 3: (void)fmi2FreeFMUstate(component, &none); break;
    case 4: (void)fmi2SerializedFMUstateSize(component, *saved, pick(60) ? &size : NULL); break;
    default: bytes(component, saved); break;
    }
}

static void statuses(fmi2Component component)
{
    fmi2StatusKind kind = (fmi2StatusKind)pick(5);
    fmi2Status status;
    fmi2Real real;
    fmi2Integer integer;
    fmi2String text;
    bool given = pick(60) != 0;
    switch (pick(5)) {
    case 0: (void)fmi2GetStatus(component, kind, given ? &status : NULL); break;
    case 1: (void)fmi2GetRealStatus(component, kind, given ? &real : NULL); break;
    case 2: (void)fmi2GetIntegerStatus(component, kind, given ? &integer : NULL); break;
    case 3: (void)fmi2GetBooleanStatus(component, kind, given ? &integer : NULL); break;
    default: (void)fmi2GetStringStatus(component, kind, given ? &text : NULL); break;
    }
}

static void life(fmi2Component component)
{
    const char *names[] = {"logStatusWarning", "logStatusError", "none", NULL};
    const char *chosen[2];
    chosen[0] = names[pick(4)];
    chosen[1] = names[pick(4)];
    switch (pick(10)) {
    case 0: (void)fmi2SetDebugLogging(component, (int)pick(2), pick(3), pick(20) ? chosen : NULL); break;
    case 1:
        (void)fmi2SetupExperiment(component, 0, 0.0, pick(4) ? 0.0 : any_real(), pick(5) == 0, any_real());
        break;
    case 2:
    case 3: (void)fmi2EnterInitializationMode(component); break;
    case 4:
    case 5: (void)fmi2ExitInitializationMode(component); break;
    case 6: (void)(pick(8) ? fmi2OK : fmi2Terminate(component)); break;
    case 7: (void)(pick(20) ? fmi2OK : fmi2CancelStep(component)); break;
    case 8:
        if (pick(10)) {
            break;
        }
        if (pick(4)) {
            fmi2ValueReference references[2] = {pick(300), pick(300)};
            fmi2Real reals[2] = {any_real(), any_real()};
            (void)fmi2GetDirectionalDerivative(component, references, pick(3), references, pick(3), reals, reals);
        } else {
            (void)fmi2GetDirectionalDerivative(component, NULL, pick(2), NULL, pick(2), NULL, NULL);
        }
        break;
    default: (void)(pick(4) ? fmi2OK : fmi2Reset(component)); break;
    }
}

static void step(fmi2Component component)
{
    double time = pick(10) ? (double)pick(1000) * 1e-3 : any_real();
    double size = pick(10) ? (double)pick(1000) * 1e-5 : any_real();
    if (size > 1e3 && pick(50) != 0) {
        size = 1e-3; /* a damper takes its time over an hour */
    }
    stepped += fmi2DoStep(component, time, size, (int)pick(2)) == fmi2OK;
}

static void start(fmi2Component component)
{
    (void)fmi2Reset(component);
    (void)fmi2SetupExperiment(component, 0, 0.0, 0.0, 0, 0.0);
    (void)fmi2EnterInitializationMode(component);
    (void)fmi2ExitInitializationMode(component);
}

static void call(fmi2Component *component, fmi2FMUstate *saved)
{
    static const fmi2CallbackFunctions full = {logger, allocate, release, NULL, NULL};
    if (*component == NULL) {
        starving = pick(20) == 0;
        *component = fmi2Instantiate(pick(20) ? "fuzz %s%n" : pick(2) ? NULL : " ",
                                     pick(20) ? fmi2CoSimulation : (fmi2Type)pick(3), any_token(), NULL,
                                     pick(50) ? &full : NULL, 0, (int)pick(2));
        return;
    }
    if (((Instance *)*component)->state.mode == BROKEN && pick(3) == 0) {
        start(*component);
        return;
    }
    switch (pick(16)) {
    case 0: states(*component, saved); break;
    case 1: bytes(*component, saved); break;
    case 2: statuses(*component); break;
    case 3: life(*component); break;
    case 4: derivatives(*component); break;
    case 5: start(*component); break;
    case 6:
    case 7:
    case 8:
    case 9: step(*component); break;
    case 10:
        if (pick(30) == 0) {
            fmi2FreeInstance(*component);
            *component = NULL;
        }
        break;
    default: values(*component); break;
    }
}

/* fuzz SEED CALLS: prints how far it got, exits 0 if nothing is left behind */
int main(int count, char **words)
{
    static const fmi2CallbackFunctions full = {logger, allocate, release, NULL, NULL};
    fmi2Component components[INSTANCES] = {NULL};
    fmi2FMUstate saved[SAVED] = {NULL};
    fmi2Component last;
    long calls;
    int i;
    seed = count > 1 ? strtoull(words[1], NULL, 10) : 1;
    for (calls = count > 2 ? atol(words[2]) : 1000; calls > 0; calls--) {
        call(&components[pick(INSTANCES)], &saved[pick(SAVED)]);
    }
    starving = 0;
    last = fmi2Instantiate("last", fmi2CoSimulation, MODEL_TOKEN, NULL, &full, 0, 0);
    for (i = 0; i < SAVED; i++) {
        if (fmi2FreeFMUstate(last, &saved[i]) != fmi2OK) {
            return 2;
        }
    }
    for (i = 0; i < INSTANCES; i++) {
        fmi2FreeInstance(components[i]);
    }
    fmi2FreeInstance(last);
    printf("%ld %ld %ld %ld\n", stepped, restored, unpacked, refused);
    return living == 0 ? 0 : 3;
}
