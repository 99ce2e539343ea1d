/* What becomes of a frame, by mode. */
#include <errno.h>
#include <math.h>
#include <string.h>
#include <syslog.h>

#include "firmware/appliance_state.h"

void iso__appliance_complain(struct iso_appliance *appliance, const char *text)
{
    if (!appliance->complaining) {
        iso__appliance_say(appliance, LOG_WARNING, "%s", text);
    }
    appliance->complaining = true;
}

static void finish(struct iso_appliance *appliance, const struct iso_verdict *verdict)
{
    if (appliance->mode == ISO_APPLIANCE_WATCH) {
        iso__appliance_finish_visit(appliance, *verdict);
    } else {
        iso__appliance_finish_recognition(appliance, verdict);
    }
}

void iso__appliance_time(struct iso_appliance *appliance, int64_t t_ns)
{
    struct iso_verdict verdict;
    if (iso_decision_time(&appliance->decision, t_ns, &verdict)) {
        finish(appliance, &verdict);
    }
}

/* The gallery's opinion of the template just extracted: 0, -ENODATA, or an error of the search. */
static int compare(const struct iso_appliance *appliance, struct iso_decision_frame *out)
{
    const struct iso_pipeline *pipeline = &appliance->parts.pipeline;
    const struct iso_gallery *gallery = appliance->parts.gallery;
    const struct iso_search_entry *entries;
    struct iso_search_hit hits[2];
    int n_entries = 0, n = 0;
    if (appliance->mode == ISO_APPLIANCE_VERIFY) {
        entries = iso_gallery_entries_of(gallery, appliance->person.id, &n_entries);
    } else {
        entries = iso_gallery_entries(gallery, &n_entries);
    }
    const int error = pipeline->ops->search(pipeline->self, entries, n_entries,
                                            &appliance->extraction.tmpl, hits, 2, &n);
    if (error) {
        return error;
    }
    *out = (struct iso_decision_frame){
        .person = n > 0 ? hits[0].person : 0,
        .score = n > 0 ? hits[0].score : NAN,
        .second_score = n > 1 ? hits[1].score : -INFINITY,
    };
    return 0;
}

/* Takes a usable face in. OK, or why it is none after all. */
static enum iso_capture recognise(struct iso_appliance *appliance, int64_t t_ns, int64_t arrival_ns)
{
    struct iso_decision_frame face;
    struct iso_verdict verdict;
    const int error = compare(appliance, &face);
    if (error) {
        if (error != -ENODATA) {
            iso__appliance_complain(appliance, strerror(-error));
        }
        return ISO_CAPTURE_TOO_FEW_POINTS;
    }
    face.t_ns = t_ns;
    /* Who somebody is does not depend on the time; whether the door opens does. */
    face.valid = appliance->mode != ISO_APPLIANCE_WATCH ||
                 iso__appliance_is_valid(appliance, face.person);
    if (appliance->decision.state == ISO_DECISION_IDLE) {
        appliance->arrival_ns = arrival_ns;
    }
    if (iso_decision_face(&appliance->decision, &face, &verdict)) {
        finish(appliance, &verdict);
    }
    return ISO_CAPTURE_OK;
}

static enum iso_capture take_face(struct iso_appliance *appliance, int64_t t_ns, int64_t arrival_ns)
{
    return appliance->mode == ISO_APPLIANCE_ENROLL ? iso__appliance_enroll_face(appliance)
                                                   : recognise(appliance, t_ns, arrival_ns);
}

static int extract(struct iso_appliance *appliance, const struct iso_frame *frame)
{
    const struct iso_pipeline *pipeline = &appliance->parts.pipeline;
    const int error = pipeline->ops->extract(pipeline->self, frame, appliance->keeper.model,
                                             &appliance->extraction);
    if (error) {
        struct iso_fault fault;
        (void)iso_fault_set(&fault, error, "frame %llu: no template: %s",
                            (unsigned long long)frame->sequence, strerror(-error));
        iso__appliance_complain(appliance, fault.text);
    }
    return error;
}

void iso__appliance_frame(struct iso_appliance *appliance, const struct iso_frame *frame,
                          int64_t arrival_ns)
{
    iso__appliance_time(appliance, frame->t_ns);
    if (appliance->mode == ISO_APPLIANCE_CLAIMED || extract(appliance, frame)) {
        return;
    }
    enum iso_capture capture = appliance->extraction.outcome;
    if (capture == ISO_CAPTURE_OK) {
        appliance->complaining = false;
        capture = take_face(appliance, frame->t_ns, arrival_ns);
        iso_template_wipe(&appliance->extraction.tmpl);
    }
    if (capture != ISO_CAPTURE_OK) {
        iso__appliance_hint(appliance, capture);
    }
}

int64_t iso__appliance_due_ns(const struct iso_appliance *appliance)
{
    const int64_t decision_ns = iso_decision_due_ns(&appliance->decision);
    if (appliance->mode == ISO_APPLIANCE_WATCH || decision_ns < appliance->deadline_ns) {
        return decision_ns;
    }
    return appliance->deadline_ns;
}
