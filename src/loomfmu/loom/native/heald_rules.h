/* Rules of claims on heald frames: how long they dwell and leave the shed clear, by the angle that the shaft turns. */

struct spans { /* when a motion is at the lower end of its stroke, and at the upper one */
    struct stretches at[2];
};

/* ---- spans of a frame: how long, a stroke, and what tells how near to an end of it the frame is to be */

/* What some stretches of time and others have in common. */
static struct stretches common(struct run *run, const struct stretches *some, const struct stretches *others)
{
    struct stretches found = {0, 0, NULL};
    for (ptrdiff_t one = 0; one < some->count; one++)
        for (ptrdiff_t other = 0; other < others->count; other++) {
            double start = larger(some->list[one].start, others->list[other].start);
            double end = smaller(some->list[one].end, others->list[other].end);
            if (start < end)
                add_stretch(run, &found, start, end, start > time_at(run, 0) && end < end_of(run));
        }
    return found;
}

/* Times from entering to leaving a distance from either end; a motion that swings as far beyond is not near, if `both_ways`.
 *
 * A frame that holds stays within: its span is as long as the picks it holds for. */
static struct spans spans_of(struct motion *lift, double distance, double stroke, bool both_ways)
{
    struct spans spans = {{beyond(lift, distance, -1.0), beyond(lift, stroke - distance, 1.0)}};
    if (both_ways) {
        struct stretches low = beyond(lift, -distance, 1.0), high = beyond(lift, stroke + distance, -1.0);
        spans.at[0] = common(lift->run, &spans.at[0], &low);
        spans.at[1] = common(lift->run, &spans.at[1], &high);
    }
    return spans;
}

static struct stretches in_order(struct run *run, const struct spans *spans)
{
    struct stretches all = {0, 0, NULL};
    for (int end = 0; end < 2; end++)
        for (ptrdiff_t place = 0; place < spans->at[end].count; place++) {
            struct stretch each = spans->at[end].list[place];
            add_stretch(run, &all, each.start, each.end, each.whole);
        }
    order_stretches(&all);
    return all;
}

static const char CUT_OFF[] = "one is cut off by an end of the run and may be shorter; run longer or start elsewhere";

/* What can be judged of spans that the ends of the run cut off: their lengths and starts, and a note.
 *
 * Such a span lasts at least as long as the run shows. */
static void take_cut_off(struct run *run, const struct stretches *spans, const struct moments *turned, double limit,
                         struct moments *judged, struct note *said)
{
    for (ptrdiff_t place = 0; place < spans->count; place++)
        if (turned->list[place].value >= limit)
            add_moment(run, judged, turned->list[place].value, turned->list[place].time);
    *said = (struct note){"none begins and ends within the run", PLAIN};
    if (spans->count == 0)
        said->words = "the frame never gets there in this run";
    else if (spans->count == 1 && spans->list[0].start == time_at(run, 0) && spans->list[0].end == end_of(run))
        said->words = judged->count == 0 ? "the frame stays there all the time, but the run is too short to tell"
                                         : "the frame stays there throughout the run";
    else if (judged->count == spans->count)
        said->words = "cut off by an end of the run: it lasts at least this long";
    else if (judged->count > 0)
        *said = (struct note){CUT_OFF, DOUBTFUL};
}

/* The least turn of the shaft during one of the spans of a motion, its time, and a note. */
static struct moment shortest(struct run *run, const struct spans *spans, double limit, struct note *said)
{
    struct motion *turning = shaft_of(run);
    struct stretches all = in_order(run, spans);
    struct moments turned = {0, 0, NULL}, judged = {0, 0, NULL};
    *said = (struct note){"", PLAIN};
    for (ptrdiff_t place = 0; place < all.count; place++) {
        const struct stretch *span = &all.list[place];
        double turn = fabs(value_of(turning, span->end) - value_of(turning, span->start));
        add_moment(run, &turned, turn, span->start);
        if (span->whole)
            add_moment(run, &judged, turn, span->start);
        else if (turn < limit)
            *said = (struct note){CUT_OFF, DOUBTFUL};
    }
    if (judged.count == 0)
        take_cut_off(run, &all, &turned, limit, &judged, said);
    return first_lowest(&judged, SAME);
}

/* The time between the spans of a frame around one of them. */
static struct stretch around(struct run *run, const struct stretches *every, const struct stretch *span)
{
    struct stretch free = {time_at(run, 0), end_of(run), false};
    for (ptrdiff_t each = 0; each < every->count; each++) {
        if (every->list[each].end <= span->start)
            free.start = larger(free.start, every->list[each].end);
        if (every->list[each].start >= span->end)
            free.end = smaller(free.end, every->list[each].start);
    }
    return free;
}

/* The first span of a frame, between those around it, in which its carrier is never at that end: its start and a note.
 *
 * Spans that an end of the run cuts off count only if the carrier is never at an end: it may come later. */
static bool is_missed(struct run *run, const struct motion *carrier, double stroke, const struct spans spans[2],
                      const char *instead, double *time, struct note *said)
{
    const struct stretches every = in_order(run, &spans[1]), own = in_order(run, &spans[0]);
    const struct stretch *found = NULL;
    struct stretch missed = {0.0, 0.0, false};
    int missed_end = 0;
    for (int end = 0; end < 2; end++)
        for (ptrdiff_t place = 0; place < spans[1].at[end].count; place++) {
            const struct stretch *span = &spans[1].at[end].list[place], free = around(run, &every, span);
            bool there = false;
            for (ptrdiff_t each = 0; each < spans[0].at[end].count; each++)
                there = there || (spans[0].at[end].list[each].end > free.start && spans[0].at[end].list[each].start < free.end);
            if (!there && (span->whole || own.count == 0) && (found == NULL || by_start(span, found) < 0)) {
                found = span;
                missed = free;
                missed_end = end;
            }
        }
    if (found == NULL)
        return false;
    double away = INFINITY;
    for (ptrdiff_t place = 0; place < run->samples; place++)
        if (missed.start <= time_at(run, place) && time_at(run, place) <= missed.end)
            away = smaller(away, fabs(sample(carrier, 1, place) - missed_end * stroke));
    *time = found->start;
    *said = (struct note){text(run, "springs and warp keep the carrier %.3g mm or more from the %s end of its frame's stroke; %s",
                               1e3 * away, missed_end == 0 ? "lower" : "upper", instead), PLAIN};
    return true;
}

static double distance_of(const struct call *call, bool dwells)
{
    const double *number = call->number; /* a share of the stroke; or a height of the warp, and its ratio to the lift */
    return dwells ? number[2] * number[1] : 0.5 * number[1] - number[2] / number[3];
}

static void judge_span(struct run *run, const struct call *call, struct answer *answer, bool dwells)
{
    const double stroke = call->number[1], distance = distance_of(call, dwells);
    const char *instead = dwells ? "clear_shed judges the shed that it leaves, lifted_by = \"frame\" the dwell of the drive"
                                 : "lifted_by = \"frame\" judges the drive alone";
    struct motion *lift[2] = {0};
    struct spans spans[2];
    struct note said[2];
    struct moment turn[2] = {{NAN, NAN}, {NAN, NAN}};
    answer->fails_for_good = false; /* a carrier may still come to an end of its stroke */
    if (turns_back(run))
        answer->unseen = "the shaft turns back, so that no turn tells how long a dwell lasts";
    for (ptrdiff_t each = 0; each < call->signals; each++) {
        lift[each] = curve(run, signal_of(call, each));
        spans[each] = spans_of(lift[each], distance, stroke, dwells);
        turn[each] = shortest(run, &spans[each], answer->bound, &said[each]);
    }
    const bool has_frame = isfinite(turn[1].value);
    if (has_frame && is_missed(run, lift[0], stroke, spans, instead, &turn[0].time, &said[0]))
        turn[0].value = 0.0;
    take_moment(answer, turn[0]);
    note(run, answer, said[0].words, said[0].weight);
    note_unknown(run, answer, lift[0]);
    if (has_frame)
        note(run, answer, text(run, "its frame: %s", degrees(run, turn[1].value)), PLAIN);
}

static void judge_dwell(struct run *run, const struct call *call, struct answer *answer)
{
    judge_span(run, call, answer, true);
}

static void judge_clear_shed(struct run *run, const struct call *call, struct answer *answer)
{
    if (0.0 < call->number[2] && call->number[2] < 0.5 * call->number[1] * call->number[3])
        judge_span(run, call, answer, false);
    else
        found_nothing(run, answer, "the warp never gets that far to either side");
}

/* The largest share, the stroke, then angles. */
static void judge_dwell_contains(struct run *run, const struct call *call, struct answer *answer)
{
    const double stroke = call->number[1];
    const char *missing = "";
    struct times times = {0, 0, NULL};
    for (ptrdiff_t place = 2; place < call->numbers; place++) {
        struct times there = times_at(run, call->number[place]);
        for (ptrdiff_t each = 0; each < there.count; each++)
            add_time(run, &times, there.list[each]);
        if (there.count == 0)
            missing = text(run, "%s%s%s", missing, *missing == '\0' ? "" : ", ", degrees(run, call->number[place]));
    }
    answer->unseen = *missing == '\0' ? "" : text(run, "the run never reaches %s", missing);
    answer->worst = answer->time = NAN;
    note_unknown(run, answer, curve(run, signal_of(call, 0)));
    for (ptrdiff_t lift = 0; lift < call->signals && times.count > 0; lift++) {
        struct moments away = {0, 0, NULL};
        for (ptrdiff_t place = 0; place < times.count; place++) {
            double there = value_of(curve(run, signal_of(call, lift)), times.list[place]);
            add_moment(run, &away, -smaller(fabs(there), fabs(stroke - there)) / stroke, times.list[place]);
        }
        struct moment farthest = first_lowest(&away, SAME);
        farthest.value = -farthest.value;
        if (lift == 0)
            take_moment(answer, farthest);
        else
            note(run, answer, text(run, "its frame: %.4g %%", 100.0 * farthest.value), PLAIN);
    }
}
