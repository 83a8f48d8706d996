/* The motor as an FMI 3.0 co-simulation FMU. */

#include <stdlib.h>

#include "fmi3FunctionTypes.h"
#include "motor.h"

#ifndef LATE /* whether rates are computed on leaving initialization, and not before */
#define LATE 0
#endif

#ifndef ENDS_AT /* s: when it ends the simulation */
#define ENDS_AT 1.0e300
#endif

typedef struct {
    Motor motor;
    fmi3LogMessageCallback log;
    fmi3InstanceEnvironment environment;
    fmi3Int8 Int8; /* of each type one: what is set and read by any reference */
    fmi3UInt8 UInt8;
    fmi3Int16 Int16;
    fmi3UInt16 UInt16;
    fmi3UInt32 UInt32;
    fmi3UInt64 UInt64;
    double table[2], u[4]; /* arrays: parameters and inputs */
} Instance;

const char *fmi3GetVersion(void) { return "3.0"; }

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
                                         fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean events,
                                         fmi3Boolean early, const fmi3ValueReference intermediate[], size_t count,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback update)
{
    Instance *instance;
    (void)name, (void)resources, (void)visible, (void)logging, (void)events, (void)early, (void)intermediate;
    (void)count, (void)update;
    if (strcmp(token, "{motor-3}") != 0) {
        log(environment, fmi3Error, "error", "another token");
        return NULL;
    }
    instance = calloc(1, sizeof(Instance));
    motor_defaults(&instance->motor);
    instance->table[0] = 1.0, instance->table[1] = 2.0;
    instance->log = log;
    instance->environment = environment;
    return instance;
}

void fmi3FreeInstance(fmi3Instance c) { free(c); }

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean defined, fmi3Float64 tolerance,
                                       fmi3Float64 start, fmi3Boolean stop_defined, fmi3Float64 stop)
{
    Instance *i = c;
    (void)defined, (void)tolerance, (void)stop_defined, (void)stop;
    i->motor.time = start;
    if (i->motor.inertia <= 0.0) {
        i->log(i->environment, fmi3Error, "error", "J is not above 0");
        return fmi3Error;
    }
    if (!LATE) motor_rates(&i->motor);
    return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance c)
{
    motor_rates(&((Instance *)c)->motor);
    return fmi3OK;
}

fmi3Status fmi3Terminate(fmi3Instance c) { (void)c; return fmi3OK; }
fmi3Status fmi3Reset(fmi3Instance c) { (void)c; return fmi3Error; }

static double *real(Motor *m, fmi3ValueReference r)
{
    double *all[] = {&m->inertia, &m->stall_torque, &m->free_speed, &m->load, &m->phi, &m->w, &m->a, &m->time};
    return all[r];
}

/* 50 the array table, 80 the input u, 81 the output y = table[1] * u + table[2] * w, the latter two 2 by 2 */
static fmi3Status whole(fmi3ValueReference r, size_t n, size_t k)
{
    return n == 1 && k == (r == 50 ? 2u : 4u) ? fmi3OK : fmi3Error;
}

fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Float64 v[], size_t k)
{
    Instance *i = c;
    if (r[0] == 81) {
        for (size_t j = 0; j < 4; j++) v[j] = i->table[0] * i->u[j] + i->table[1] * i->motor.w;
        return whole(r[0], n, k);
    }
    for (size_t j = 0; j < n && j < k; j++) v[j] = *real(&((Instance *)c)->motor, r[j]);
    return fmi3OK;
}

fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Float64 v[], size_t k)
{
    Instance *i = c;
    if (r[0] == 50 || r[0] == 80) {
        memcpy(r[0] == 50 ? i->table : i->u, v, k * sizeof *v);
        return whole(r[0], n, k);
    }
    for (size_t j = 0; j < n && j < k; j++) *real(&((Instance *)c)->motor, r[j]) = v[j];
    return fmi3OK;
}

/* integers: 20 the steps made, 22 the parameter verbose that counts, as 20 does, in Int32 */
fmi3Status fmi3GetInt32(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Int32 v[], size_t k)
{
    Motor *m = &((Instance *)c)->motor;
    for (size_t j = 0; j < n && j < k; j++) v[j] = r[j] == 20 ? m->steps : m->verbose;
    return fmi3OK;
}

fmi3Status fmi3SetInt32(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Int32 v[], size_t k)
{
    for (size_t j = 0; j < n && j < k; j++) if (r[j] == 22) ((Instance *)c)->motor.verbose = v[j];
    return fmi3OK;
}

/* enumerations: 30 the parameter mode, 31 the same as an output; 32 an Int64: millionths of a radian turned */
fmi3Status fmi3GetInt64(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Int64 v[], size_t k)
{
    Motor *m = &((Instance *)c)->motor;
    for (size_t j = 0; j < n && j < k; j++) v[j] = r[j] == 32 ? (fmi3Int64)(m->phi * 1e6) : m->mode;
    return fmi3OK;
}

#define HELD(type)                                                                                              \
    fmi3Status fmi3Get##type(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3##type v[], size_t k)    \
    {                                                                                                             \
        (void)r;                                                                                                  \
        for (size_t j = 0; j < n && j < k; j++) v[j] = ((Instance *)c)->type;                                     \
        return fmi3OK;                                                                                            \
    }                                                                                                             \
    fmi3Status fmi3Set##type(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3##type v[],        \
                             size_t k)                                                                            \
    {                                                                                                             \
        (void)r;                                                                                                  \
        for (size_t j = 0; j < n && j < k; j++) ((Instance *)c)->type = v[j];                                     \
        return fmi3OK;                                                                                            \
    }

HELD(Int8)
HELD(UInt8)
HELD(Int16)
HELD(UInt16)
HELD(UInt32)
HELD(UInt64)

fmi3Status fmi3GetFloat32(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Float32 v[], size_t k)
{
    (void)r;
    for (size_t j = 0; j < k; j++) v[j] = (fmi3Float32)(((Instance *)c)->motor.w * (j + 1.0));
    return fmi3OK;
}

fmi3Status fmi3SetInt64(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Int64 v[], size_t k)
{
    for (size_t j = 0; j < n && j < k; j++) if (r[j] == 30) ((Instance *)c)->motor.mode = (int)v[j];
    return fmi3OK;
}

fmi3Status fmi3GetBoolean(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Boolean v[], size_t k)
{
    (void)r;
    for (size_t j = 0; j < n && j < k; j++) v[j] = ((Instance *)c)->motor.at_speed != 0;
    return fmi3OK;
}

fmi3Status fmi3SetBoolean(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Boolean v[], size_t k)
{
    Motor *m = &((Instance *)c)->motor;
    for (size_t j = 0; j < n && j < k; j++) if (r[j] == 41 && v[j]) m->load = 1.0e9;
    return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 time, fmi3Float64 h, fmi3Boolean keep, fmi3Boolean *event,
                      fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *reached)
{
    Instance *i = c;
    (void)keep;
    *event = *early = false;
    *terminate = i->motor.load > i->motor.stall_torque || time + h > ENDS_AT - 1e-12;
    h = time + h > ENDS_AT - 1e-12 ? ENDS_AT - time : h;
    *reached = time + h;
    if (i->motor.verbose && i->motor.steps < i->motor.verbose) {
        i->log(i->environment, fmi3Warning, "load", "it turns, 100 %s of it");
    }
    motor_step(&i->motor, h);
    return fmi3OK;
}

/* what the standard wants to be there and the motor has not */

#define NOT_THERE(name) fmi3Status name(void) { return fmi3Error; }

NOT_THERE(fmi3SetDebugLogging)
NOT_THERE(fmi3InstantiateModelExchange)
NOT_THERE(fmi3InstantiateScheduledExecution)
NOT_THERE(fmi3EnterEventMode)
NOT_THERE(fmi3GetString)
NOT_THERE(fmi3GetBinary)
NOT_THERE(fmi3GetClock)
NOT_THERE(fmi3SetFloat32)
NOT_THERE(fmi3SetString)
NOT_THERE(fmi3SetBinary)
NOT_THERE(fmi3SetClock)
NOT_THERE(fmi3GetNumberOfVariableDependencies)
NOT_THERE(fmi3GetVariableDependencies)
NOT_THERE(fmi3GetFMUState)
NOT_THERE(fmi3SetFMUState)
NOT_THERE(fmi3FreeFMUState)
NOT_THERE(fmi3SerializedFMUStateSize)
NOT_THERE(fmi3SerializeFMUState)
NOT_THERE(fmi3DeserializeFMUState)
NOT_THERE(fmi3GetDirectionalDerivative)
NOT_THERE(fmi3GetAdjointDerivative)
NOT_THERE(fmi3EnterConfigurationMode)
NOT_THERE(fmi3ExitConfigurationMode)
NOT_THERE(fmi3GetIntervalDecimal)
NOT_THERE(fmi3GetIntervalFraction)
NOT_THERE(fmi3GetShiftDecimal)
NOT_THERE(fmi3GetShiftFraction)
NOT_THERE(fmi3SetIntervalDecimal)
NOT_THERE(fmi3SetIntervalFraction)
NOT_THERE(fmi3SetShiftDecimal)
NOT_THERE(fmi3SetShiftFraction)
NOT_THERE(fmi3EvaluateDiscreteStates)
NOT_THERE(fmi3UpdateDiscreteStates)
NOT_THERE(fmi3EnterContinuousTimeMode)
NOT_THERE(fmi3CompletedIntegratorStep)
NOT_THERE(fmi3SetTime)
NOT_THERE(fmi3SetContinuousStates)
NOT_THERE(fmi3GetContinuousStateDerivatives)
NOT_THERE(fmi3GetEventIndicators)
NOT_THERE(fmi3GetContinuousStates)
NOT_THERE(fmi3GetNominalsOfContinuousStates)
NOT_THERE(fmi3GetNumberOfEventIndicators)
NOT_THERE(fmi3GetNumberOfContinuousStates)
NOT_THERE(fmi3EnterStepMode)
NOT_THERE(fmi3GetOutputDerivatives)
NOT_THERE(fmi3ActivateModelPartition)
