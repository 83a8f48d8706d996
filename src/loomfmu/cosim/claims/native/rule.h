/* A rule, and those on any signal. The machine lists all, in RULES. */

typedef void judge_by(struct run *, const struct call *, struct answer *);

struct rule {
    const char *name;
    judge_by *judge;
};

#define RULES_ON_SIGNALS        \
    {"bounded", judge_bounded}, \
    {"held", judge_held},       \
    {"given", judge_given}
