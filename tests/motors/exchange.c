/* Small FMUs for model exchange, FMI 2.0 and 3.0: a bouncing ball, van der Pol's oscillator, Dahlquist's equation
 * with an input, and stairs in time. The first three are those of the Reference-FMUs. */

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#if FMI == 3
#include "fmi3FunctionTypes.h"
#define F(name) fmi3##name
typedef bool Flag;
#else
#include "fmi2FunctionTypes.h"
#define F(name) fmi2##name
typedef int Flag;
#endif

#define BALL 1
#define OSCILLATOR 2
#define DAHLQUIST 3
#define STAIRS 4

enum { OK, DISCARD = 2, ERROR = 3 };

#if MODEL == BALL
enum { STATES = 2, INDICATORS = 1 };
#elif MODEL == OSCILLATOR
enum { STATES = 2, INDICATORS = 0 };
#elif MODEL == DAHLQUIST
enum { STATES = 1, INDICATORS = 0 };
#else
enum { STATES = 0, INDICATORS = 0 };
#endif

typedef struct {
    double time, x[2], parameter, input, next;
    int count, mode; /* 0 initialization, 1 event, 2 continuous time */
} Model;

static void *made(void)
{
    Model *m = calloc(1, sizeof(Model));
    m->x[0] = MODEL == OSCILLATOR ? 2.0 : 1.0;
    m->parameter = MODEL == BALL ? 0.7 : 1.0;
    m->next = 0.2;
    return m;
}

static double value(const Model *m, unsigned reference)
{
    const double *x = m->x;
    switch (reference) {
    case 1: return x[0];
    case 2: return x[1];
    case 3: return MODEL == DAHLQUIST ? m->input - m->parameter * x[0] : x[1];
    case 4: return MODEL == BALL ? -9.81 : m->parameter * ((1.0 - x[0] * x[0]) * x[1]) - x[0];
    case 5: return m->parameter;
    case 6: return m->input;
    default: return m->time;
    }
}

static int set(Model *m, unsigned reference, double given)
{
    if (reference == 5) m->parameter = given;
    else if (reference == 6) m->input = given;
    else if (reference <= 2) m->x[reference - 1] = given;
    return OK;
}

static int update(Model *m, bool *terminate, bool *defined, double *next)
{
    if (m->mode != 1) return ERROR;
    *terminate = *defined = false;
    if (MODEL == BALL && m->x[0] <= 0.0 && m->x[1] < 0.0) {
        m->x[0] = DBL_MIN;
        m->x[1] *= -m->parameter;
        m->count++;
    }
    if (MODEL == STAIRS) {
        if (m->time >= m->next) {
            m->count++;
            m->next += 0.2;
        }
        *terminate = m->count >= 9;
        *defined = true;
        *next = m->next;
    }
    return OK;
}

int F(EnterEventMode)(void *c) { ((Model *)c)->mode = 1; return OK; }
int F(EnterContinuousTimeMode)(void *c) { ((Model *)c)->mode = 2; return OK; }
int F(ExitInitializationMode)(void *c) { ((Model *)c)->mode = 1; return OK; }
int F(Terminate)(void *c) { (void)c; return OK; }
int F(Reset)(void *c) { (void)c; return ERROR; }
int F(SetTime)(void *c, double time) { ((Model *)c)->time = time; return ((Model *)c)->mode == 2 ? OK : ERROR; }
void F(FreeInstance)(void *c) { free(c); }

int F(SetContinuousStates)(void *c, const double x[], size_t count)
{
    memcpy(((Model *)c)->x, x, count * sizeof(double));
    return count == STATES && ((Model *)c)->mode == 2 ? OK : ERROR;
}

int F(GetContinuousStates)(void *c, double x[], size_t count)
{
    memcpy(x, ((Model *)c)->x, count * sizeof(double));
    return count == STATES ? OK : ERROR;
}

int F(GetNominalsOfContinuousStates)(void *c, double x[], size_t count)
{
    (void)c;
    for (size_t i = 0; i < count; i++) x[i] = 1.0;
    return OK;
}

#ifndef FAILS_AT /* s: from when on it has no derivatives */
#define FAILS_AT 1e300
#endif
#ifndef RETURNED /* what it returns then */
#define RETURNED ERROR
#endif

/* ---- what the standards have otherwise */
#if FMI == 3
int fmi3GetContinuousStateDerivatives(void *c, double rates[], size_t count)
#else
int fmi2GetDerivatives(void *c, double rates[], size_t count)
#endif
{
    bool fails = ((Model *)c)->time > FAILS_AT;
    for (size_t i = 0; i < count; i++) rates[i] = value(c, (unsigned)i + 3) + (fails ? NAN : 0.0);
    return fails ? RETURNED : OK;
}

int F(GetEventIndicators)(void *c, double z[], size_t count)
{
    Model *m = c;
    z[0] = m->x[0];
    return count == INDICATORS ? OK : ERROR;
}

int F(CompletedIntegratorStep)(void *c, Flag before, Flag *event, Flag *terminate)
{
    (void)before;
    *event = *terminate = false;
    return ((Model *)c)->mode == 2 ? OK : ERROR;
}

#if FMI == 3
#define STATE(name) fmi3##name##FMUState
#else
#define STATE(name) fmi2##name##FMUstate
#endif

int STATE(Get)(void *c, void **state)
{
    *state = *state ? *state : calloc(1, sizeof(Model));
    memcpy(*state, c, sizeof(Model));
    return OK;
}

int STATE(Set)(void *c, void *state) { memcpy(c, state, sizeof(Model)); return OK; }
int STATE(Free)(void *c, void **state) { (void)c; free(*state); *state = NULL; return OK; }

/* what the standard wants to be there and these models have not */
#define NOT_THERE(name) int F(name)(void) { return ERROR; }

#if FMI == 3
const char *fmi3GetVersion(void) { return "3.0"; }

void *fmi3InstantiateModelExchange(const char *name, const char *token, const char *resources, bool visible,
                                   bool logging, void *environment, fmi3LogMessageCallback log)
{
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)environment, (void)log;
    return made();
}

int fmi3EnterInitializationMode(void *c, bool defined, double tolerance, double start, bool stops, double stop)
{
    (void)defined, (void)tolerance, (void)stops, (void)stop;
    ((Model *)c)->time = start;
    return OK;
}

int fmi3UpdateDiscreteStates(void *c, bool *more, bool *terminate, bool *nominals, bool *states, bool *defined,
                             double *next)
{
    *more = *nominals = false;
    *states = true;
    return update(c, terminate, defined, next);
}

int fmi3GetFloat64(void *c, const unsigned r[], size_t count, double v[], size_t values)
{
    (void)values;
    for (size_t i = 0; i < count; i++) v[i] = value(c, r[i]);
    return OK;
}

int fmi3SetFloat64(void *c, const unsigned r[], size_t count, const double v[], size_t values)
{
    (void)values;
    for (size_t i = 0; i < count; i++) set(c, r[i], v[i]);
    return OK;
}

int fmi3GetInt32(void *c, const unsigned r[], size_t count, int32_t v[], size_t values)
{
    (void)r, (void)values;
    for (size_t i = 0; i < count; i++) v[i] = ((Model *)c)->count;
    return OK;
}

NOT_THERE(ActivateModelPartition) NOT_THERE(DeserializeFMUState) NOT_THERE(DoStep) NOT_THERE(EnterConfigurationMode)
NOT_THERE(EnterStepMode) NOT_THERE(EvaluateDiscreteStates) NOT_THERE(ExitConfigurationMode)
NOT_THERE(GetAdjointDerivative) NOT_THERE(GetBinary) NOT_THERE(GetBoolean) NOT_THERE(GetClock)
NOT_THERE(GetDirectionalDerivative) NOT_THERE(GetFloat32) NOT_THERE(GetInt16) NOT_THERE(GetInt64) NOT_THERE(GetInt8)
NOT_THERE(GetIntervalDecimal) NOT_THERE(GetIntervalFraction) NOT_THERE(GetNumberOfContinuousStates)
NOT_THERE(GetNumberOfEventIndicators) NOT_THERE(GetNumberOfVariableDependencies) NOT_THERE(GetOutputDerivatives)
NOT_THERE(GetShiftDecimal) NOT_THERE(GetShiftFraction) NOT_THERE(GetString) NOT_THERE(GetUInt16)
NOT_THERE(GetUInt32) NOT_THERE(GetUInt64) NOT_THERE(GetUInt8) NOT_THERE(GetVariableDependencies)
NOT_THERE(InstantiateCoSimulation) NOT_THERE(InstantiateScheduledExecution) NOT_THERE(SerializeFMUState)
NOT_THERE(SerializedFMUStateSize) NOT_THERE(SetBinary) NOT_THERE(SetBoolean) NOT_THERE(SetClock)
NOT_THERE(SetDebugLogging) NOT_THERE(SetFloat32) NOT_THERE(SetInt16) NOT_THERE(SetInt32) NOT_THERE(SetInt64)
NOT_THERE(SetInt8) NOT_THERE(SetIntervalDecimal) NOT_THERE(SetIntervalFraction) NOT_THERE(SetShiftDecimal)
NOT_THERE(SetShiftFraction) NOT_THERE(SetString) NOT_THERE(SetUInt16) NOT_THERE(SetUInt32) NOT_THERE(SetUInt64)
NOT_THERE(SetUInt8)
#else
const char *fmi2GetVersion(void) { return "2.0"; }
const char *fmi2GetTypesPlatform(void) { return "default"; }

void *fmi2Instantiate(const char *name, fmi2Type type, const char *guid, const char *resources,
                      const fmi2CallbackFunctions *callbacks, int visible, int logging)
{
    (void)name, (void)guid, (void)resources, (void)callbacks, (void)visible, (void)logging;
    return type == fmi2ModelExchange ? made() : NULL;
}

int fmi2SetupExperiment(void *c, int defined, double tolerance, double start, int stops, double stop)
{
    (void)defined, (void)tolerance, (void)stops, (void)stop;
    ((Model *)c)->time = start;
    return OK;
}

int fmi2EnterInitializationMode(void *c) { (void)c; return OK; }

int fmi2NewDiscreteStates(void *c, fmi2EventInfo *info)
{
    bool terminate, defined;
    int status = update(c, &terminate, &defined, &info->nextEventTime);
    info->newDiscreteStatesNeeded = info->nominalsOfContinuousStatesChanged = false;
    info->valuesOfContinuousStatesChanged = true;
    info->terminateSimulation = terminate;
    info->nextEventTimeDefined = defined;
    return status;
}

int fmi2GetReal(void *c, const unsigned r[], size_t count, double v[])
{
    for (size_t i = 0; i < count; i++) v[i] = value(c, r[i]);
    return OK;
}

int fmi2SetReal(void *c, const unsigned r[], size_t count, const double v[])
{
    for (size_t i = 0; i < count; i++) set(c, r[i], v[i]);
    return OK;
}

int fmi2GetInteger(void *c, const unsigned r[], size_t count, int v[])
{
    (void)r;
    for (size_t i = 0; i < count; i++) v[i] = ((Model *)c)->count;
    return OK;
}

NOT_THERE(DeSerializeFMUstate) NOT_THERE(GetBoolean) NOT_THERE(GetDirectionalDerivative) NOT_THERE(GetString)
NOT_THERE(SerializeFMUstate) NOT_THERE(SerializedFMUstateSize) NOT_THERE(SetBoolean) NOT_THERE(SetDebugLogging)
NOT_THERE(SetInteger) NOT_THERE(SetString)
#endif
