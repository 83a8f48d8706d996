/* What the hosts of either standard that keep no rules share: random numbers, references and bytes. */
#define SAVED 4
#define ROOM (STATE_SIZE + 64)

static uint64_t seed;
static long stepped, restored, unpacked, refused; /* that the fuzz gets somewhere */

static unsigned pick(unsigned below)
{
    seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (unsigned)(seed >> 33) % below;
}

static double any_real(void)
{
    static const double odd[] = {0.0, -0.0, 1.0, -1.0, 1e-300, 5e-324, 1e18, 1e300, -HUGE_VAL, NAN, HUGE_VAL};
    return pick(4) == 0 ? odd[pick(11)] : ((double)pick(2000001) - 1e6) * pow(10.0, (double)pick(16) - 12.0);
}

/* Mostly a value that the variable takes, so that calls get past the checks. */
static double fitting_real(unsigned reference)
{
    double low, high;
    const unsigned place = reference - FIRST_REFERENCE;
    if (place >= VARIABLES || pick(12) == 0) {
        return any_real();
    }
    low = rows[place].low > -1e6 ? rows[place].low : -1e3;
    high = rows[place].high < 1e6 ? rows[place].high : 1e3;
    return low + (high - low) * (double)pick(1000001) * 1e-6;
}

/* Mostly a reference of the kind asked for and, when setting, one that may be set. */
static unsigned any_reference(Kind kind, bool setting)
{
    unsigned tries;
    for (tries = 0; tries < 100 && pick(40) != 0; tries++) {
        unsigned place = pick(VARIABLES);
        if (rows[place].kind == kind && (!setting || rows[place].causality <= INPUT)) {
            return place + FIRST_REFERENCE;
        }
    }
    return pick(2) ? pick(VARIABLES + 3) : 4294967295U;
}

/* Any bytes; how many. */
static size_t any_bytes(unsigned char *content)
{
    size_t i, size = pick(4) ? STATE_SIZE : pick((unsigned)ROOM);
    for (i = 0; i < size; i++) {
        content[i] = (unsigned char)pick(256);
    }
    return size;
}

/* Damages the bytes of a true state, or leaves them as they are. */
static void damage(unsigned char *content)
{
    unsigned flips = pick(4);
    while (flips-- > 0) {
        content[pick(STATE_SIZE)] ^= (unsigned char)(1 << pick(8));
    }
    if (pick(3) == 0) { /* a checksum that fits lets damage pass on to the other checks */
        Stream stream = {content + STATE_SIZE - 8, true};
        memcpy(content, LAYOUT, 8);
        memcpy(content + 8, MODEL_TOKEN, TOKEN_SIZE);
        (void)fmu_pass_bits(&stream, fmu_checksum(content, STATE_SIZE - 8), 8);
    }
}

static void count_bytes(bool taken)
{
    unpacked += taken;
    refused += !taken;
}
