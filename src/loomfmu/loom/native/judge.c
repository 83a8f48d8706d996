/* The rules of all claims on a recorded run of a loom. */

/* in this order: each builds on those above it */
#include "../../cosim/claims/native/run.h"
#include "../../cosim/claims/native/bernstein.h"
#include "../../cosim/claims/native/curves.h"
#include "../../cosim/claims/native/extremes.h"
#include "../../cosim/claims/native/shaft.h"
#include "../../cosim/claims/native/verdicts.h"
#include "../../cosim/claims/native/signal_rules.h"
#include "../../cosim/claims/native/rule.h"
#include "held_rules.h"
#include "heald_rules.h"
#include "loom_rules.h"
#include "energy_rule.h"

static const struct rule RULES[] = {
    RULES_ON_SIGNALS,
    {"margin", judge_margin, NULL},
    {"deflection", judge_deflection, NULL},
    {"contacts", judge_contacts, NULL},
    {"blows", judge_blows, NULL},
    {"power", judge_power, NULL},
    {"fluctuation", judge_fluctuation, NULL},
    {"energy", judge_energy, NULL},
    {"dwell", judge_dwell, look_at_dwells},
    {"clear_shed", judge_clear_shed, look_at_sheds},
    {"dwell_contains", judge_dwell_contains, look_at_turns},
    {"shed", judge_shed, NULL},
    {"reed", judge_reed, NULL},
    {"transfer", judge_transfer, look_at_passes},
    {"transfer_speed", judge_transfer_speed, look_at_meetings},
    {"nip", judge_nip, NULL},
    {"locks", judge_locks, NULL},
};

#include "../../cosim/claims/native/judge.h"
