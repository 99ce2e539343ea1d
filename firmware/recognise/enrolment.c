#include "firmware/recognise/enrolment.h"

#include <errno.h>
#include <math.h>

#include "core/match/template_fuse.h"

void iso_enrolment_begin(struct iso_enrolment *enrolment,
                         const struct iso_enrolment_options *options, int64_t now_ns)
{
    iso_enrolment_wipe(enrolment);
    enrolment->options = *options;
    enrolment->state = ISO_ENROLMENT_ACTIVE;
    enrolment->deadline_ns = now_ns + options->timeout_ns;
    enrolment->pose_deadline_ns = INT64_MAX;
    enrolment->pose = ISO_ENROLL_FRONTAL;
    enrolment->stage = 0;
    enrolment->stages = options->stages +
                        (iso_enrolment_steps(enrolment) - 1) * options->pose_stages;
    enrolment->taken = 0;
    enrolment->misfits = 0;
    enrolment->attack_frames = 0;
    enrolment->cue = ISO_CAPTURE_OK;
    enrolment->duplicate_of = 0;
}

static bool is_frontal(const struct iso_enrolment *enrolment)
{
    return enrolment->pose == ISO_ENROLL_FRONTAL;
}

static int stages_of_step(const struct iso_enrolment *enrolment)
{
    return is_frontal(enrolment) ? enrolment->options.stages : enrolment->options.pose_stages;
}

/* Goes on with the next step, or ends the enrolment after the last one. */
static void end_step(struct iso_enrolment *enrolment, int64_t now_ns)
{
    enrolment->pose++;
    if ((int)enrolment->pose >= iso_enrolment_steps(enrolment)) {
        enrolment->state = ISO_ENROLMENT_COMPLETED;
        return;
    }
    enrolment->taken = 0;
    enrolment->misfits = 0;
    enrolment->pose_deadline_ns = now_ns + enrolment->options.pose_timeout_ns;
}

/* Goes on without the present pose. An enrolment whose last attack frames no good frame followed
 * does not complete in this way: it ends in state `in_doubt`, which is that of a frontal step that
 * is given up for the same reason. */
static void leave_out(struct iso_enrolment *enrolment, int64_t now_ns,
                      enum iso_enrolment_state in_doubt)
{
    iso_template_wipe(&enrolment->fused[enrolment->pose]);
    enrolment->stages -= stages_of_step(enrolment);
    enrolment->stage -= enrolment->taken;
    end_step(enrolment, now_ns);
    if (enrolment->state == ISO_ENROLMENT_COMPLETED && enrolment->attack_frames > 0) {
        enrolment->state = in_doubt;
    }
}

/* The best score of a probe among these templates; -INFINITY if there are none, if too few points
 * can be compared, or if the score is no number. */
static int best_score(const struct iso_pipeline *pipeline, const struct iso_candidate_list *among,
                      const struct iso_template *probe, double *out)
{
    struct iso_search_hit hit;
    int n = 0;
    const int error = pipeline->ops->search(pipeline->self, among, probe, &hit, 1, &n);
    if (error && error != -ENODATA) {
        return error;
    }
    *out = error || n == 0 || isnan(hit.score) ? -INFINITY : hit.score;
    return 0;
}

/* The lowest score of a frame compared with the frontal template and with the frames of the step
 * before it; INFINITY if there are none. */
static int lowest_score(const struct iso_enrolment *enrolment, const struct iso_template *frame,
                        const struct iso_pipeline *pipeline, double *out)
{
    double lowest = INFINITY;
    for (int i = is_frontal(enrolment) ? 0 : -1; i < enrolment->taken; i++) {
        const struct iso_search_entry entry = {.person = 1,
                                               .tmpl = i < 0 ? &enrolment->fused[ISO_ENROLL_FRONTAL]
                                                             : &enrolment->frames[i]};
        const struct iso_candidate_list before = {.entries = &entry, .n_entries = 1};
        double score = 0;
        const int error = best_score(pipeline, &before, frame, &score);
        if (error) {
            return error;
        }
        lowest = fmin(lowest, score);
    }
    *out = lowest;
    return 0;
}

/* Searches the gallery for another person with this face. *out is the number of that person; it
 * stays unchanged if there is none. */
static int find_duplicate(const struct iso_enrolment *enrolment, const struct iso_template *tmpl,
                          const struct iso_pipeline *pipeline,
                          const struct iso_enrolment_gallery *gallery, int64_t *out)
{
    struct iso_search_hit hits[2]; /* one of the hits may be the enrolled person */
    int n = 0;
    const int error = pipeline->ops->search(pipeline->self, &gallery->everybody, tmpl, hits, 2, &n);
    if (error) {
        return error == -ENODATA ? 0 : error;
    }
    for (int i = 0; i < n; i++) {
        if (hits[i].person != gallery->person &&
            hits[i].score >= enrolment->options.duplicate_score) {
            *out = hits[i].person;
            return 0;
        }
    }
    return 0;
}

/* Compares a template with the one to which it has to belong: the frontal template of a person with
 * those that the person has already, that of another pose with the frontal one. *out is the score;
 * INFINITY if there is nothing to compare with. */
static int compare_own(const struct iso_enrolment *enrolment, const struct iso_template *tmpl,
                       const struct iso_pipeline *pipeline,
                       const struct iso_enrolment_gallery *gallery, double *out)
{
    const struct iso_search_entry entry = {.person = 1,
                                           .tmpl = &enrolment->fused[ISO_ENROLL_FRONTAL]};
    const struct iso_candidate_list frontal = {.entries = &entry, .n_entries = 1};
    if (!is_frontal(enrolment)) {
        return best_score(pipeline, &frontal, tmpl, out);
    }
    *out = INFINITY;
    return iso_candidates_none(&gallery->own) ? 0 : best_score(pipeline, &gallery->own, tmpl, out);
}

/* The lowest score with which a template belongs to a person. A pose other than the frontal one has
 * few frames, and somebody who looks like the person may pass all of them. The template that is
 * made of them has to reach a higher score, because it is less noisy than a frame. */
static double lowest_own(const struct iso_enrolment *enrolment)
{
    const struct iso_enrolment_options *options = &enrolment->options;
    return is_frontal(enrolment) ? options->agree_score
                                 : fmax(options->agree_score,
                                        0.5 * (options->agree_score + options->duplicate_score));
}

/* Compares the template of a step with the person and with the gallery, and sets the state that
 * follows. Returns an error of a comparison. */
static int judge(struct iso_enrolment *enrolment, const struct iso_template *tmpl,
                 const struct iso_pipeline *pipeline, const struct iso_enrolment_gallery *gallery,
                 int64_t now_ns)
{
    double own;
    int64_t duplicate = 0;
    int error = compare_own(enrolment, tmpl, pipeline, gallery, &own);
    if (!error && !enrolment->options.allow_duplicate) {
        error = find_duplicate(enrolment, tmpl, pipeline, gallery, &duplicate);
    }
    if (error) {
        return error;
    }
    enrolment->duplicate_of = duplicate;
    if (duplicate != 0) {
        enrolment->state = ISO_ENROLMENT_DUPLICATE;
    } else if (own < lowest_own(enrolment) && is_frontal(enrolment)) {
        enrolment->state = ISO_ENROLMENT_OTHER_FACE;
    } else if (own < lowest_own(enrolment)) {
        leave_out(enrolment, now_ns, ISO_ENROLMENT_FAILED);
    } else {
        enrolment->kept[enrolment->pose] = true;
        end_step(enrolment, now_ns);
    }
    return 0;
}

static int complete_step(struct iso_enrolment *enrolment, const struct iso_pipeline *pipeline,
                         const struct iso_enrolment_gallery *gallery, int64_t now_ns)
{
    const struct iso_template *frames[ISO_ENROLMENT_STAGES_MAX];
    struct iso_template *fused = &enrolment->fused[enrolment->pose];
    for (int i = 0; i < enrolment->taken; i++) {
        frames[i] = &enrolment->frames[i];
    }
    const int error = iso_template_fuse(&enrolment->registration, frames, enrolment->taken, fused);
    if (error == -ENODATA && !is_frontal(enrolment)) {
        leave_out(enrolment, now_ns, ISO_ENROLMENT_FAILED);
        return 0;
    }
    return error ? error : judge(enrolment, fused, pipeline, gallery, now_ns);
}

/* In the frontal step, too many misfits end the enrolment. In another step they only end this pose:
 * a bowed head may fail to be recognised although the frontal template is good. */
static void take_misfit(struct iso_enrolment *enrolment, int64_t now_ns)
{
    enrolment->misfits++;
    if (enrolment->misfits < enrolment->options.stages) {
        return;
    }
    if (is_frontal(enrolment)) {
        enrolment->state = ISO_ENROLMENT_FAILED;
    } else {
        leave_out(enrolment, now_ns, ISO_ENROLMENT_FAILED);
    }
}

int iso_enrolment_frame(struct iso_enrolment *enrolment, const struct iso_template *frame,
                        int64_t now_ns, const struct iso_pipeline *pipeline,
                        const struct iso_enrolment_gallery *gallery, bool *passed)
{
    const int stage = enrolment->stage;
    double score = 0;
    int error = lowest_score(enrolment, frame, pipeline, &score);
    if (error) {
        return error;
    }
    if (score < enrolment->options.agree_score) {
        *passed = false;
        take_misfit(enrolment, now_ns);
        return 0;
    }
    enrolment->frames[enrolment->taken++] = *frame;
    enrolment->stage++;
    enrolment->attack_frames = 0;
    if (enrolment->taken == stages_of_step(enrolment)) {
        error = complete_step(enrolment, pipeline, gallery, now_ns);
        if (error) {
            enrolment->state = ISO_ENROLMENT_FAILED;
            return error;
        }
    }
    *passed = enrolment->stage > stage; /* a pose that is left out takes its stages back */
    return 0;
}

void iso_enrolment_attack(struct iso_enrolment *enrolment, enum iso_capture cue)
{
    enrolment->attack_frames++;
    enrolment->cue = cue;
    if (enrolment->attack_frames >= enrolment->options.attack_frames) {
        enrolment->state = ISO_ENROLMENT_ATTACK;
    }
}

void iso_enrolment_time(struct iso_enrolment *enrolment, int64_t now_ns)
{
    if (now_ns >= enrolment->deadline_ns && is_frontal(enrolment)) {
        enrolment->state = ISO_ENROLMENT_TIMED_OUT;
        return;
    }
    while (enrolment->state == ISO_ENROLMENT_ACTIVE && now_ns >= iso_enrolment_due_ns(enrolment)) {
        leave_out(enrolment, now_ns, ISO_ENROLMENT_TIMED_OUT);
    }
}

int64_t iso_enrolment_due_ns(const struct iso_enrolment *enrolment)
{
    return enrolment->pose_deadline_ns < enrolment->deadline_ns ? enrolment->pose_deadline_ns
                                                                : enrolment->deadline_ns;
}

void iso_enrolment_disconnect(struct iso_enrolment *enrolment)
{
    enrolment->state = ISO_ENROLMENT_DISCONNECTED;
}

void iso_enrolment_wipe(struct iso_enrolment *enrolment)
{
    for (int i = 0; i < ISO_ENROLMENT_STAGES_MAX; i++) {
        iso_template_wipe(&enrolment->frames[i]);
    }
    for (int i = 0; i < ISO_ENROLL_POSES; i++) {
        iso_template_wipe(&enrolment->fused[i]);
        enrolment->kept[i] = false;
    }
}
