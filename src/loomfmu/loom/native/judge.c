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
    {"margin", judge_margin},
    {"deflection", judge_deflection},
    {"contacts", judge_contacts},
    {"blows", judge_blows},
    {"power", judge_power},
    {"fluctuation", judge_fluctuation},
    {"energy", judge_energy},
    {"dwell", judge_dwell},
    {"clear_shed", judge_clear_shed},
    {"dwell_contains", judge_dwell_contains},
    {"shed", judge_shed},
    {"reed", judge_reed},
    {"transfer", judge_transfer},
    {"transfer_speed", judge_transfer_speed},
    {"nip", judge_nip},
    {"locks", judge_locks},
};

#include "../../cosim/claims/native/judge.h"
