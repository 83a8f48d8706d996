/* What the tables of a component's variables and problems are made of. */
#ifndef TABLES_H
#define TABLES_H

#include <stdbool.h>
#include <stddef.h>

#define NONE (-1)
#define CATEGORIES 3

typedef enum { REAL, INTEGER, BOOLEAN } Kind;
typedef enum { PARAMETER, INPUT, OUTPUT, LOCAL } Causality;
typedef enum { FIXED, TUNABLE, DISCRETE, CONTINUOUS } Variability;

/* A variable: where it stands in the component, its limits, and the unit that people read it in. */
typedef struct {
    const char *name;
    Kind kind;
    Causality causality;
    Variability variability;
    size_t offset;
    double low;
    double high;
    const char *display;
    double factor;
    int rate; /* the variable that is its time derivative, or NONE */
} Row;

/* What a component reports by number; `{name}` in its text stands for the value of a variable. */
typedef struct {
    const char *text;
    bool warning;
} Problem;

#endif
