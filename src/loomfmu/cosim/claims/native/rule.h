/* A rule, and those on any signal. The machine lists all, in RULES. */

typedef void judge_by(struct run *, const struct call *, struct answer *);
typedef void add_looks(struct run *, const struct call *, struct times *);

struct rule {
    const char *name;
    judge_by *judge;
    add_looks *looks; /* adds the times at which it looks, as far as they are known before its extremes are */
};

static void add_all(struct run *run, struct times *times, struct times others)
{
    for (ptrdiff_t place = 0; place < others.count; place++)
        add_time(run, times, others.list[place]);
}

static void look_at_edges(struct run *run, const struct call *call, struct times *times)
{
    const double *number = call->number;
    if (number[2] == 0.0)
        return;
    add_all(run, times, times_at(run, number[3]));
    add_all(run, times, times_at(run, number[5]));
}

#define RULES_ON_SIGNALS                       \
    {"bounded", judge_bounded, look_at_edges}, \
    {"held", judge_held, NULL},                \
    {"given", judge_given, NULL}
