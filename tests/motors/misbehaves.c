/* The FMI 2.0 motor, which does one thing that no FMU may do: MISBEHAVES, in WHERE, from AT s on in a step. */

#define _GNU_SOURCE
#include <fenv.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define fmi2Terminate motor_Terminate
#define fmi2FreeInstance motor_FreeInstance
#define fmi2EnterInitializationMode motor_EnterInitializationMode
#define fmi2DoStep motor_DoStep
#include "fmi2.c"
#undef fmi2Terminate
#undef fmi2FreeInstance
#undef fmi2EnterInitializationMode
#undef fmi2DoStep

enum { CRASH, HANG, EXIT, ABORT, MOVE, FLOOD, PRINT, CLOSE, CHILD, LOG, STATUS, QUIT, OVERWRITE, FORK, ROUND, DAEMON };
enum { STEP, INITIALIZATION, TERMINATE, FREE };

#ifndef RETURNED
#define RETURNED 0
#endif
#ifndef AT
#define AT 0.05
#endif

static void misbehave(Instance *i)
{
    switch (MISBEHAVES) {
    case CRASH:
        *(volatile int *)8 = 1;
        break;
    case HANG:
        for (;;) pause();
    case EXIT:
        exit(0);
    case QUIT: /* the system's own call: no handler of the C library is asked */
        _exit(0);
    case OVERWRITE: { /* the memory that it shares with the master */
        char line[512];
        unsigned long from, to;
        FILE *maps = fopen("/proc/self/maps", "r");
        while (maps && fgets(line, sizeof line, maps))
            if (strstr(line, "/memory") && sscanf(line, "%lx-%lx", &from, &to) == 2)
                memset((void *)from, 0x7f, to - from);
        abort();
    }
    case ABORT:
        fprintf(stderr, "motor: \033[31massertion failed\n");
        abort();
    case MOVE:
        if (chdir("/")) abort();
        break;
    case FLOOD: /* on both streams, by the time it is ended more than any disk should be given */
        for (;;) fprintf(stderr, "the motor turns, and turns, and turns, and turns\n");
    case PRINT:
        for (int line = 0; line < 10000; line++) printf("line %d of what nobody asked for\n", line);
        break;
    case CLOSE:
        for (int file = 3; file < 256; file++) close(file);
        for (;;) pause();
    case CHILD: /* it holds on to all that its parent had open */
        if (fork() == 0)
            for (;;) pause();
        *(volatile int *)8 = 1;
        break;
    case DAEMON: /* a server in a session of its own, started by a process that ends at once */
        if (fork() == 0) {
            setsid();
            if (fork() == 0)
                for (;;) pause();
            _exit(0);
        }
        if (RETURNED) *(volatile int *)8 = 1;
        break;
    case FORK: /* both go on */
        fork();
        break;
    case ROUND: /* as some numerical libraries do */
        fesetround(FE_UPWARD);
        break;
    case LOG:
        for (int line = 0; line < 10000; line++)
            i->functions->logger(i->functions->componentEnvironment, i->name, fmi2Warning, "load", "line %d", line);
        break;
    }
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    if (WHERE == INITIALIZATION) misbehave(c);
    return motor_EnterInitializationMode(c);
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real h, fmi2Boolean keep)
{
    if (WHERE == STEP && time > AT - 1e-9 && ((Instance *)c)->motor.mode == 1) {
        if (MISBEHAVES == STATUS) return (fmi2Status)RETURNED;
        misbehave(c);
    }
    return motor_DoStep(c, time, h, keep);
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    if (WHERE == TERMINATE) misbehave(c);
    return motor_Terminate(c);
}

void fmi2FreeInstance(fmi2Component c)
{
    if (WHERE == FREE) misbehave(c);
    motor_FreeInstance(c);
}
