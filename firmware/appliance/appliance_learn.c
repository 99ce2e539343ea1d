/* WATCH: learns a template at a visit, deletes learned templates, and takes into use what the
 * people have taught the metric. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <syslog.h>

#include "drivers/terminal/words.h"
#include "firmware/appliance/appliance_calls.h"
#include "firmware/appliance/appliance_claim.h"
#include "firmware/recognise/learning.h"
#include "isotherm/capture.h"

/* Whether the present template is similar enough to the enrolled ones among these. */
static bool is_like(const struct iso_appliance *appliance,
                    const struct iso_learning_options *options, int64_t person,
                    const struct iso_template *own, int n)
{
    struct iso_search_entry enrolled[ISO_GALLERY_TEMPLATES_MAX];
    const struct iso_pipeline *pipeline = &appliance->borrowed.pipeline;
    const struct iso_candidate_list among = {
        .entries = enrolled,
        .n_entries = iso_learning_enrolled(person, own, n, enrolled),
    };
    struct iso_search_hit hit;
    int n_hits = 0;
    if (among.n_entries == 0 || n - among.n_entries >= options->templates) {
        return false;
    }
    const int error = pipeline->ops->search(pipeline->self, &among,
                                            &appliance->face.extraction.tmpl, &hit, 1, &n_hits);
    return !error && n_hits == 1 && hit.score >= options->score;
}

/* Whether there is room for one more learned template of this person, and the present template is
 * similar to the enrolled ones on the disk. */
static bool may_learn(const struct iso_appliance *appliance,
                      const struct iso_learning_options *options, int64_t person)
{
    int n = 0;
    struct iso_fault fault = {.text = ""};
    struct iso_template *own = calloc(ISO_GALLERY_TEMPLATES_MAX, sizeof *own);
    if (!own) {
        return false;
    }
    const int error = iso_gallery_templates(appliance->borrowed.gallery, person, own,
                                            ISO_GALLERY_TEMPLATES_MAX, &n, &fault);
    const bool like = !error && is_like(appliance, options, person, own, n);
    for (int i = 0; i < n; i++) {
        iso_template_wipe(&own[i]);
    }
    free(own);
    return like;
}

/* Stores the template, after the record of it. Without a record nothing is stored. */
static void keep(struct iso_appliance *appliance, const struct iso_verdict *verdict)
{
    struct iso_gallery *gallery = appliance->borrowed.gallery;
    const struct iso_person *known = iso_gallery_find_id(gallery, verdict->person);
    struct iso_audit_record record = iso_audit_record_of("learn");
    struct iso_fault fault = {.text = ""};
    if (!known || iso_gallery_room(gallery, known->name, 1, NULL)) {
        return;
    }
    const struct iso_person person = *known; /* a copy: the gallery's array may move */
    record.person = person.name;
    record.score = verdict->score;
    if (iso__appliance_record(appliance, &record)) {
        return;
    }
    struct iso_template *learned = &appliance->face.extraction.tmpl;
    learned->learned = true;
    const int error = iso_gallery_add(gallery, &person, learned, &fault);
    learned->learned = false;
    if (error) {
        iso__appliance_say(appliance, LOG_ERR, "a learned template could not be stored");
        record.note = fault.text;
        record.reason = "not-stored";
        (void)iso__appliance_record(appliance, &record);
    } else {
        iso__appliance_record_gallery(appliance, "gallery", NULL);
    }
}

void iso__appliance_learn(struct iso_appliance *appliance, const struct iso_verdict *verdict)
{
    const struct iso_config_update *config = &appliance->borrowed.config->update;
    const struct iso_learning_options options = {config->templates, config->score};
    if (iso_learning_is_sure(&options, &appliance->visit.decision, verdict) &&
        appliance->visit.image.contradicted == 0 &&
        iso__appliance_enroll_gate(appliance) == ISO_CAPTURE_OK &&
        may_learn(appliance, &options, verdict->person)) {
        keep(appliance, verdict);
    }
}

void iso__appliance_unlearn(struct iso_appliance *appliance)
{
    size_t n = 0;
    char note[64];
    struct iso_fault fault = {.text = ""};
    if (appliance->borrowed.config->update.templates > 0) {
        return;
    }
    if (iso_gallery_forget_learned(appliance->borrowed.gallery, &n, &fault)) {
        iso__appliance_say(appliance, LOG_ERR, "learned templates could not be deleted: %s",
                           fault.text);
    } else if (n > 0) {
        struct iso_audit_record record = iso_audit_record_of("forget");
        (void)snprintf(note, sizeof note, "%zu learned templates", n);
        record.note = note;
        (void)iso__appliance_record(appliance, &record);
        iso__appliance_record_gallery(appliance, "gallery", NULL);
    }
}

static void record_site(struct iso_appliance *appliance, const struct iso_site_state *state)
{
    const struct iso_site_summary *summary = &state->summary;
    struct iso_audit_record record = iso_audit_record_of("site");
    char note[160];
    (void)snprintf(note, sizeof note, "%d %s, offset %.2f (expected %.2f), variance within %.2f",
                   summary->people, iso_plural((uint64_t)summary->people, "person", "people"),
                   summary->offset, summary->expected, summary->growth);
    record.reason = state->adapted ? "adapted" : "shipped";
    record.note = note;
    (void)iso__appliance_note(appliance, &record);
    iso__appliance_say(appliance, LOG_INFO, "site: the metric is %s: %s",
                       state->adapted ? "adapted" : "the shipped one", note);
}

void iso__appliance_follow_site(struct iso_appliance *appliance)
{
    const bool followed = iso_gallery_follow_site(appliance->borrowed.gallery);
    const struct iso_site_state state = iso_gallery_site(appliance->borrowed.gallery);
    if (followed) {
        record_site(appliance, &state);
    }
    if (state.error && state.error != appliance->site_error) {
        iso__appliance_say(appliance, LOG_ERR, "site: the metric could not be adapted: %s",
                           strerror(-state.error));
    }
    appliance->site_error = state.error;
}
