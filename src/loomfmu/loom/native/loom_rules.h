/* Rules of claims on the loom: its drive, and that its mechanisms keep out of each other's way. */

/* ---- the drive */

static void judge_power(struct run *run, const struct call *call, struct answer *answer)
{
    take_extreme(answer, noted_extreme(run, answer, signal_of(call, 0), -1.0, NULL));
}

/* The bound, and how many revolutions are left out. */
static void judge_fluctuation(struct run *run, const struct call *call, struct answer *answer)
{
    const int velocity = signal_of(call, 0);
    const double skip = ceil(call->number[1]);
    struct times times = revolutions(run);
    answer->worst = answer->time = NAN;
    answer->unseen = short_but_for_shaft(run); /* each revolution is judged by itself, as far as there is one */
    note_unknown(run, answer, curve(run, velocity));
    const ptrdiff_t last = run->samples - 1;
    for (ptrdiff_t place = 0; place < times.count && times.count > 1; place++) {
        const bool whole = place + 1 < times.count; /* of an unfinished one, what the run shows counts */
        struct stretch turn = {times.list[place], whole ? times.list[place + 1] : end_of(run), true};
        struct stretches within = {1, 1, &turn};
        double end = sample(shaft_of(run), 1, last), turned = whole ? TURN : fabs(end - value_of(shaft_of(run), turn.start));
        if ((double)place < skip || (!whole && (isnan(answer->worst) || turned < STANDS * TURN)))
            continue;
        struct extreme low = noted_extreme(run, answer, velocity, 1.0, &within);
        struct extreme high = noted_extreme(run, answer, velocity, -1.0, &within);
        /* the mean of an unfinished revolution is not known, but no larger than its highest speed will be */
        double mean = whole ? TURN / (turn.end - turn.start) : larger(fabs(high.value), fabs(low.value));
        double fluctuation = mean > 0.0 ? (high.value - low.value) / mean : 0.0;
        if (!(fluctuation <= answer->worst)) {
            answer->worst = fluctuation;
            answer->time = low.time;
            answer->between = mean > 0.0 ? (known_doubt(low) + known_doubt(high)) / mean : 0.0;
        }
    }
    if (isnan(answer->worst) && times.count > 1 && skip >= (double)(times.count - 1))
        note(run, answer,
             text(run, "skip = %.0f leaves none of the whole revolutions of the run: it has %.0f and needs %.0f; raise revolutions",
                  skip, (double)(times.count - 1), skip + 1.0),
             PLAIN);
    else if (isnan(answer->worst))
        note(run, answer, "the run has no whole revolution to judge", PLAIN);
}

/* ---- the head in the shed: the bound, the idle travel */

static struct stretches in_shed(struct run *run, const struct call *call, struct answer *answer)
{
    struct stretches found = beyond(curve(run, signal_of(call, 0)), call->number[1], 1.0);
    answer->unseen = has_whole(&found) && !turns_back(run) ? short_but_for_shaft(run) : short_run(run);
    if (found.count == 0)
        found_nothing(run, answer, "the head never enters the shed in this run");
    note_unknown(run, answer, curve(run, signal_of(call, 0)));
    return found;
}

/* The least opening by the lifts of the frames' warps, or by those of the frames: two signals each, a stroke and a ratio. */
static double opening(struct run *run, const struct call *call, const struct stretches *shed, bool alone,
                      struct answer *answer)
{
    struct moments found = {0, 0, NULL};
    bool named = alone;
    for (ptrdiff_t frame = 0; frame < call->forms; frame++) {
        const double *number = call->number + 2 + 2 * frame;
        struct motion *lift = curve(run, signal_of(call, 1 + 2 * frame + alone));
        struct extreme closest = nearest(lift, 0.5 * number[0], shed);
        add_moment(run, &found, 2.0 * number[1] * closest.value, closest.time);
        if (!alone) {
            answer->between = larger(answer->between, 2.0 * number[1] * known_doubt(closest));
            note_unknown(run, answer, lift);
            note_coarse(run, answer, closest);
        }
    }
    const double worst = first_lowest(&found, SAME).value;
    for (ptrdiff_t frame = 0; frame < call->forms && !alone; frame++) {
        const struct moment *each = &found.list[frame];
        if (!(each->value > worst + SAME) && (!named || each->time < answer->time)) {
            answer->time = each->time;
            answer->form = (int)frame;
            named = true;
        }
    }
    return worst;
}

static void judge_shed(struct run *run, const struct call *call, struct answer *answer)
{
    struct stretches shed = in_shed(run, call, answer);
    bool carried = false;
    if (shed.count == 0)
        return;
    for (ptrdiff_t frame = 0; frame < call->forms; frame++)
        carried = carried || signal_of(call, 1 + 2 * frame) != signal_of(call, 2 + 2 * frame);
    answer->worst = opening(run, call, &shed, false, answer);
    if (carried)
        note(run, answer, text(run, "the frames: %.4g mm", opening(run, call, &shed, true, answer) / 0.001), PLAIN);
}

static void judge_reed(struct run *run, const struct call *call, struct answer *answer)
{
    struct stretches shed = in_shed(run, call, answer);
    if (shed.count == 0)
        return;
    take_extreme(answer, noted_extreme(run, answer, signal_of(call, 1), -1.0, &shed));
    answer->worst = last_of(run, signal_of(call, 2)) - answer->worst;
}

/* ---- the transfer: the overlap that the hooks need, and a window, or the largest speed */

static void judge_transfer(struct run *run, const struct call *call, struct answer *answer)
{
    const struct window window = window_of(call->number + 1);
    struct motion *overlap = curve(run, signal_of(call, 0));
    struct stretches within = passes(run, window);
    struct moments found = {0, 0, NULL};
    answer->unseen = unpassed(run, window);
    note_unknown(run, answer, overlap);
    for (ptrdiff_t place = 0; place < within.count; place++) {
        struct stretches pass = {1, 1, &within.list[place]};
        struct extreme most = lowest(overlap, -1.0, &pass);
        answer->between = larger(answer->between, known_doubt(most));
        add_moment(run, &found, most.value, most.time);
        note_coarse(run, answer, most);
    }
    if (within.count == 0) {
        found_nothing(run, answer, UNPASSED);
        return;
    }
    take_moment(answer, first_lowest(&found, SAME));
    struct stretches during = beyond(overlap, answer->bound, 1.0);
    for (ptrdiff_t place = 0; place < during.count; place++) {
        const struct stretch *each = &during.list[place];
        if (each->whole && each->start <= answer->time && answer->time <= each->end)
            note(run, answer,
                 text(run, "hand-over from %s to %s", degrees(run, place_at(run, each->start).angle),
                      degrees(run, place_at(run, each->end).angle)),
                 PLAIN);
    }
}

static struct extreme farther(struct extreme one, struct extreme other)
{
    return fabs(other.value) > fabs(one.value) ? other : one;
}

static void judge_transfer_speed(struct run *run, const struct call *call, struct answer *answer)
{
    struct motion *overlap = curve(run, signal_of(call, 0));
    struct stretches during = beyond(overlap, call->number[1], 1.0);
    answer->unseen = has_whole(&during) && !turns_back(run) ? short_but_for_shaft(run) : short_run(run);
    note_unknown(run, answer, overlap);
    if (during.count == 0) {
        found_nothing(run, answer, "the heads never overlap by what the hooks need in this run");
        return;
    }
    struct extreme low = noted_extreme(run, answer, signal_of(call, 1), 1.0, &during);
    take_extreme(answer, farther(low, noted_extreme(run, answer, signal_of(call, 1), -1.0, &during)));
    answer->worst = fabs(answer->worst);
}

/* ---- a roller's nip: the least and the largest ratio, 1 if at the samples */

static void judge_nip(struct run *run, const struct call *call, struct answer *answer)
{
    struct motion *drafting = curve(run, signal_of(call, 0)), *holding = curve(run, signal_of(call, 1));
    struct extreme most = lowest(drafting, -1.0, NULL);
    answer->fails_for_good = false;
    if (!(most.value > 0.0)) {
        found_nothing(run, answer, "no fibres are drafted in this run");
        return;
    }
    struct stretches drafted = beyond(drafting, 0.0, 1.0);
    struct extreme held = lowest(holding, -1.0, &drafted);
    const double ratio = held.value / most.value, least = call->number[0], largest = call->number[1];
    answer->form = ratio - least > largest - ratio;
    answer->bound = answer->form == 1 ? largest : least;
    answer->worst = ratio;
    answer->time = most.time;
    if (!is_known(drafting))
        most.possible = sampled_possible(drafting, -1.0, NULL);
    if (!is_known(holding))
        held.possible = sampled_possible(holding, -1.0, &drafted);
    answer->between = (known_doubt(held) + ratio * known_doubt(most)) / most.value;
    answer->holds = least - SAME <= ratio && ratio <= largest + SAME;
    note_coarse(run, answer, most);
    note_coarse(run, answer, held);
    if (call->number[2] == 0.0) {
        note_unknown_with(run, answer, drafting, AT_SAMPLES);
        note_unknown_with(run, answer, holding, AT_SAMPLES);
    }
}

/* ---- pattern locks: their limit of speed, whether they are in time, their margin, and the shaft's velocity */

/* The verdict on a lock that does not follow the main shaft: what it says at the samples. */
static void judge_lock_at_samples(struct run *run, const struct call *call, struct answer *answer)
{
    const int in_time = signal_of(call, 1), margin = signal_of(call, 2);
    ptrdiff_t least = 0, late = -1;
    for (ptrdiff_t place = 0; place < run->samples; place++) {
        if (late < 0 && sample_of(run, in_time, place) == 0.0)
            late = place;
        if (sample_of(run, margin, place) < sample_of(run, margin, least))
            least = place;
    }
    answer->form = 1;
    answer->bound = 0.0;
    answer->worst = sample_of(run, margin, late >= 0 ? late : least);
    answer->time = time_at(run, late >= 0 ? late : least);
    answer->holds = late < 0;
    note(run, answer,
         text(run, "%s is known only at the samples: the lock does not follow shaft.velocity", run->signals[in_time].name),
         DOUBTFUL);
}

static void judge_locks(struct run *run, const struct call *call, struct answer *answer)
{
    const double limit = last_of(run, signal_of(call, 0));
    const int velocity = signal_of(call, 3);
    bool follows = velocity >= 0;
    for (ptrdiff_t place = 0; follows && place < run->samples; place++)
        follows = (fabs(sample_of(run, velocity, place)) <= limit) == (sample_of(run, signal_of(call, 1), place) != 0.0);
    if (!follows) {
        judge_lock_at_samples(run, call, answer);
        return;
    }
    struct motion *speed = motion_of(run, velocity, 1);
    struct extreme fastest = farther(lowest(speed, 1.0, NULL), lowest(speed, -1.0, NULL));
    take_extreme(answer, fastest);
    answer->worst = fabs(fastest.value);
    answer->bound = limit;
    note_unknown(run, answer, speed);
    note_coarse(run, answer, fastest);
}
