/* One instance of a component, and what the shells of FMI 2 and FMI 3 have in common.
 *
 * Each shell is one translation unit: it says what a Host is, then includes these files, so that nothing
 * but the functions of the standard has a name outside. No global is ever written, and nothing is
 * allocated but an instance and a copy of its state.
 */
#ifndef INSTANCE_H
#define INSTANCE_H

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "grid.h"
#include "model.h"

#define TEXT_SIZE 2048
#define HIGHEST_ORDER 3 /* of the derivatives of an input */

/* The numbers of both standards. */
typedef enum { OK, WARNING, DISCARD, FAILED } Status;

/* One bit for each, so that a set of them says where a function may be called. */
typedef enum {
    INSTANTIATED = 1,
    INITIALIZING = 2,
    STEPPING = 4,
    STEP_FAILED = 8,
    TERMINATED = 16,
    BROKEN = 32,
    EVENTS = 64,
    CONTINUOUS_TIME = 128
} Mode;

/* What the outputs were computed from, for their derivatives: nothing after a step that failed. */
typedef enum { NOWHERE, START, STEP } OriginKind;

typedef struct {
    Component component;
    int kind; /* an OriginKind */
    double time;
    double size;
    bool carried;                   /* its inputs are those of the end of the step */
    unsigned char given[VARIABLES]; /* which of their derivatives were given */
} Origin;

/* All that a host saves and restores. */
typedef struct {
    Component component;
    Origin origin;
    int mode; /* a Mode */
    double time;      /* where the component stands */
    double stop_time; /* HUGE_VAL for none */
    bool set_up;      /* the host has told the start time */
    bool stale;       /* the start is to be computed from what was set since */
    bool carried;     /* inputs are carried to the end of each step */
    unsigned char given[VARIABLES]; /* bit n - 1: the derivative of order n was given for this step */
    double derivatives[VARIABLES][HIGHEST_ORDER]; /* the last member: not copied where not carried */
} State;

typedef struct {
    State state;
    Host host;
    bool logged[CATEGORIES];
    bool warned[PROBLEMS + 1];
    Status last_step;
    char *name;
} Instance;

typedef struct {
    char text[TEXT_SIZE];
    size_t length;
} Text;

/* Hands a message to the host; each shell has its own. */
static void fmu_tell(Instance *instance, Status status, const char *category, const char *message);

#endif
