/* An audit record has "sequence" (1, 2, ...), "time" (UTC, RFC 3339), "event" and, where they
 * apply, "monotonic_ns", "person", "verdict", "door", "door_fault", "grant", "reason", "score",
 * "threshold", "frames", "attack_frames", "sensor", "gallery" (which one, ":" and how often it was
 * changed), "before" and "after" (the values that an administrator changed), "note".
 *
 * The admission of a person is recorded twice: as a "grant" before the lock is switched, and as a
 * "visit" after it. The visit says what the door did ("door", "door_fault") and which record was
 * the grant ("grant", a sequence). If a grant has no visit, the daemon ended in between, or its
 * disk was full. */
#ifndef ISO_FIRMWARE_CONTRACT_LOG_EVENTS_H
#define ISO_FIRMWARE_CONTRACT_LOG_EVENTS_H

/* Every "event" of an audit record, in alphabetical order: the values of an array of texts. */
#define ISO_CONTRACT_EVENTS                                                                        \
    "act", "attack", "clock", "commission", "counter", "credential", "delete", "door",             \
        "door-test", "duress", "enroll", "export", "fleet", "forget", "gallery", "grant",          \
        "identify", "import", "learn", "lockdown", "lockout", "log-recovered", "log-rotated",      \
        "log-sealed", "panel", "picture", "policy", "records-lost", "relief", "rename",            \
        "rotate-keys", "sensor", "setting", "site", "start", "state-accepted", "stop", "validity", \
        "verify", "visit"

#endif
