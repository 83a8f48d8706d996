/* A motor with finite inertia: J dw/dt = tau_stall (1 - w / w_free) - load, solved exactly over a step of
   constant load. It stands for what other tools export. */

#include <math.h>
#include <string.h>

typedef struct {
    double inertia, stall_torque, free_speed, load; /* J, tau_stall, w_free, load.tau */
    double phi, w, a, time;
    int steps, at_speed, verbose, mode; /* mode: 1 both ways, 2 it does not turn back */
} Motor;

static void motor_defaults(Motor *m)
{
    memset(m, 0, sizeof *m);
    m->inertia = 0.5;
    m->stall_torque = 100.0;
    m->free_speed = 60.0;
    m->mode = 1;
}

static void motor_rates(Motor *m)
{
    m->a = (m->stall_torque * (1.0 - m->w / m->free_speed) - m->load) / m->inertia;
    m->at_speed = m->w > 0.9 * m->free_speed;
}

static void motor_step(Motor *m, double h)
{
    double constant = m->inertia * m->free_speed / m->stall_torque; /* of time */
    double final = m->free_speed * (1.0 - m->load / m->stall_torque);
    double away = m->w - final;
    double decay = exp(-h / constant);
    m->phi += final * h + away * constant * (1.0 - decay);
    m->w = final + away * decay;
    if (m->mode == 2 && m->w < 0.0) {
        m->w = 0.0;
    }
    m->time += h;
    m->steps += 1;
    motor_rates(m);
}
