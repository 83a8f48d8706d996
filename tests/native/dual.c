/* Steps an FMU and repeats each step with dual numbers: their values are those of plain numbers, to the bit. */
#include "fmi2.c"

static int differs(const Instance *instance, const Row *row, const DualComponent *found)
{
    const char *plain = (const char *)&instance->state.component + row->offset;
    const char *other = (const char *)found + dual_offsets[row - rows];
    return memcmp(plain, other, fmu_size(row)) != 0; /* the value is the first member of a dual number */
}

int main(void)
{
    fmi2CallbackFunctions callbacks = {NULL, NULL, NULL, NULL, NULL};
    Derivative wanted = {NULL, 0, NULL, 0};
    Instance *instance = fmi2Instantiate("tested", fmi2CoSimulation, MODEL_TOKEN, NULL, &callbacks, 0, 0);
    DualComponent found;
    int step, i, count = 0;
    (void)fmi2SetupExperiment(instance, 0, 0.0, 0.0, 0, 0.0);
    (void)fmi2EnterInitializationMode(instance);
    (void)fmi2ExitInitializationMode(instance);
    for (step = 0; step < 300; step++) {
        fmu_repeat(instance, &wanted, NULL, &found);
        for (i = 0; i < VARIABLES; i++) {
            if (differs(instance, &rows[i], &found)) {
                printf("step %d: %s\n", step, rows[i].name);
                count++;
            }
            if (rows[i].causality == INPUT && rows[i].kind == REAL && rows[i].rate != NONE) {
                double value = fmu_value(instance, &rows[i]) + 1e-3 * fmu_value(instance, &rows[rows[i].rate]);
                (void)fmu_set_real(instance, (unsigned)i + FIRST_REFERENCE, value);
            }
        }
        if (fmi2DoStep(instance, step * 1e-3, 1e-3, 1) != fmi2OK) {
            printf("step %d failed\n", step);
            return 2;
        }
    }
    fmi2FreeInstance(instance);
    return count > 0;
}
