/* A host without Python: loads an FMU, runs it for a number of steps, prints all its variables. */
#ifdef _WIN32
#include <windows.h>
#define dlopen(path, flags) ((void *)LoadLibraryA(path))
#define dlsym(library, name) ((void *)GetProcAddress((HMODULE)(library), name))
#define dlclose(library) (!FreeLibrary((HMODULE)(library)))
#define dlerror() "LoadLibrary failed"
#else
#include <dlfcn.h>
#endif
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2FunctionTypes.h"

static void *library;

static void logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                   fmi2String category, fmi2String message, ...)
{
    va_list arguments;
    va_start(arguments, message);
    fprintf(stderr, "%s [%s]: ", name, category);
    vfprintf(stderr, message, arguments);
    fputc('\n', stderr);
    va_end(arguments);
    (void)environment;
    (void)status;
}

/* ISO C has no cast from a pointer to an object to one to a function. */
#define LOAD(type, name)                                  \
    type *name;                                           \
    *(void **)&name = dlsym(library, #name);              \
    if (name == NULL) {                                   \
        fprintf(stderr, "%s is missing\n", #name);        \
        exit(2);                                          \
    }

#define MUST(call)                                        \
    if ((call) != fmi2OK) {                               \
        fprintf(stderr, "%s failed\n", #call);            \
        exit(3);                                          \
    }

/* host FMU GUID STEPS STEP_SIZE KINDS: KINDS has a letter for each value reference from 1 on: r, i or b */
int main(int count, char **words)
{
    fmi2CallbackFunctions callbacks = {logger, calloc, free, NULL, NULL};
    fmi2Component component;
    unsigned place;
    int step;
    if (count != 6 || (library = dlopen(words[1], RTLD_NOW | RTLD_LOCAL)) == NULL) {
        fprintf(stderr, "%s\n", count == 6 ? dlerror() : "usage: host FMU GUID STEPS STEP_SIZE KINDS");
        return 1;
    }
    LOAD(fmi2InstantiateTYPE, fmi2Instantiate)
    LOAD(fmi2SetupExperimentTYPE, fmi2SetupExperiment)
    LOAD(fmi2EnterInitializationModeTYPE, fmi2EnterInitializationMode)
    LOAD(fmi2ExitInitializationModeTYPE, fmi2ExitInitializationMode)
    LOAD(fmi2DoStepTYPE, fmi2DoStep)
    LOAD(fmi2GetRealTYPE, fmi2GetReal)
    LOAD(fmi2GetIntegerTYPE, fmi2GetInteger)
    LOAD(fmi2GetBooleanTYPE, fmi2GetBoolean)
    LOAD(fmi2TerminateTYPE, fmi2Terminate)
    LOAD(fmi2FreeInstanceTYPE, fmi2FreeInstance)
    component = fmi2Instantiate("alone", fmi2CoSimulation, words[2], "file:///", &callbacks, fmi2False,
                                fmi2True);
    if (component == NULL) {
        return 4;
    }
    MUST(fmi2SetupExperiment(component, fmi2False, 0.0, 0.0, fmi2False, 0.0))
    MUST(fmi2EnterInitializationMode(component))
    MUST(fmi2ExitInitializationMode(component))
    for (step = 0; step < atoi(words[3]); step++) {
        MUST(fmi2DoStep(component, step * atof(words[4]), atof(words[4]), fmi2True))
    }
    for (place = 0; place < strlen(words[5]); place++) {
        fmi2ValueReference reference = place + 1;
        fmi2Real real = 0.0;
        fmi2Integer integer = 0;
        if (words[5][place] == 'r') {
            MUST(fmi2GetReal(component, &reference, 1, &real))
        } else if (words[5][place] == 'i') {
            MUST(fmi2GetInteger(component, &reference, 1, &integer))
        } else {
            MUST(fmi2GetBoolean(component, &reference, 1, &integer))
        }
        printf("%.17g\n", words[5][place] == 'r' ? real : (double)integer);
    }
    MUST(fmi2Terminate(component))
    fmi2FreeInstance(component);
    return dlclose(library);
}
