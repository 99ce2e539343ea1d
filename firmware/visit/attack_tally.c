#include "firmware/visit/attack_tally.h"

#include "drivers/base/times.h"

void iso_attack_tally_init(struct iso_attack_tally *tally, int64_t quiet_ns, int64_t longest_ns)
{
    *tally = (struct iso_attack_tally){.quiet_ns = quiet_ns, .longest_ns = longest_ns};
}

void iso_attack_tally_frame(struct iso_attack_tally *tally, enum iso_capture cue, int64_t t_ns)
{
    if (tally->frames == 0) {
        iso_attack_tally_init(tally, tally->quiet_ns, tally->longest_ns);
        tally->cue = cue;
        tally->first_ns = t_ns;
    }
    tally->frames++;
    tally->by_cue[cue]++;
    tally->last_ns = t_ns;
    if (tally->by_cue[cue] > tally->by_cue[tally->cue]) {
        tally->cue = cue;
    }
}

bool iso_attack_tally_end(struct iso_attack_tally *tally, struct iso_attack_attempt *attempt)
{
    if (tally->frames == 0) {
        return false;
    }
    *attempt = (struct iso_attack_attempt){
        .cue = tally->cue,
        .frames = tally->frames,
        .duration_ns = tally->last_ns - tally->first_ns,
    };
    tally->frames = 0;
    return true;
}

bool iso_attack_tally_time(struct iso_attack_tally *tally, int64_t t_ns,
                           struct iso_attack_attempt *attempt)
{
    return t_ns >= iso_attack_tally_due_ns(tally) && iso_attack_tally_end(tally, attempt);
}

int64_t iso_attack_tally_due_ns(const struct iso_attack_tally *tally)
{
    if (tally->frames == 0) {
        return ISO_NEVER_NS;
    }
    const int64_t quiet_ns = tally->last_ns + tally->quiet_ns;
    const int64_t longest_ns = tally->first_ns + tally->longest_ns;
    return quiet_ns < longest_ns ? quiet_ns : longest_ns;
}
