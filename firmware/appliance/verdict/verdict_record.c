/* Makes the record of a verdict (firmware/audit). */
#include <stdio.h>
#include <string.h>

#include "firmware/appliance/verdict/verdict.h"

const char *iso__verdict_word(const struct iso_verdict *verdict)
{
    return verdict->allow ? "allow" : "deny";
}

/* Adds a part to the note, with a comma before all parts but the first. */
static void add_note(struct iso__verdict_note *note, const char *before, const char *what)
{
    const size_t length = strlen(note->text);
    (void)snprintf(note->text + length, sizeof note->text - length, "%s%s%s", length ? ", " : "",
                   before, what);
}

static void write_note(const struct iso_appliance *appliance, const struct iso_verdict *verdict,
                       struct iso__verdict_note *note)
{
    const struct iso_person *companion = iso_gallery_find_id(appliance->borrowed.gallery,
                                                             verdict->companion);
    if (!iso_image_tally_text(&appliance->visit.image, note->text)) {
        note->text[0] = '\0';
    }
    if (companion) {
        add_note(note, "with ", companion->name);
    }
    if (verdict->reason == ISO_REASON_NO_LEASE) {
        char why[ISO__APPLIANCE_WHY_SIZE];
        iso__appliance_why_no_lease(appliance, why);
        add_note(note, why, "");
    }
    if (verdict->passback) {
        add_note(note, "soft violation of antipassback", "");
    }
}

struct iso_audit_record iso__verdict_record(const struct iso_appliance *appliance,
                                            const char *event, const char *person,
                                            const struct iso_verdict *verdict,
                                            struct iso__verdict_note *note)
{
    struct iso_audit_record record = iso_audit_record_of(event);
    record.person = *person ? person : NULL;
    record.verdict = iso__verdict_word(verdict);
    record.reason = iso_reason_name(verdict->reason);
    record.score = verdict->score;
    record.threshold = verdict->threshold;
    record.frames = verdict->frames;
    record.sensor = iso__appliance_sensor_state(appliance);
    write_note(appliance, verdict, note);
    if (*note->text) {
        record.note = note->text;
    }
    if (verdict->attack_frames > 0) {
        record.attack_frames = verdict->attack_frames;
        record.note = iso_capture_name(verdict->cue);
    }
    return record;
}
