#include "sim/door/visit_picture.h"

#include <stdio.h>
#include <string.h>

#include "drivers/base/times.h"
#include "sim/lab/picture/visit.h"

enum { WORD_SIZE = 64 };

static double seconds(const struct sim_trace *trace, int64_t t_ns)
{
    return (double)(t_ns - trace->start_ns) / (double)ISO_NS_PER_S;
}

static void describe_frame(const struct sim_trace_frame *note, const struct iso_gallery *gallery,
                           char word[WORD_SIZE])
{
    const struct iso_person *person = iso_gallery_find_id(gallery, note->person);
    if (note->outcome != ISO_CAPTURE_OK) {
        (void)snprintf(word, WORD_SIZE, "not used: %s", iso_capture_name(note->outcome));
    } else if (!note->compared || !person) {
        (void)snprintf(word, WORD_SIZE, "not compared");
    } else {
        (void)snprintf(word, WORD_SIZE, "most similar: %.40s", person->name);
    }
}

static void describe_visit(const struct sim_visit *visit, char title[128], char subtitle[256])
{
    const struct sim_door_verdict *v = &visit->verdict;
    const char *came = strcmp(visit->row->subject, "none") == 0 ? visit->row->note
                                                                : visit->row->subject;
    if (!v->given) {
        (void)snprintf(title, 128, "No person was seen");
    } else if (v->allow) {
        (void)snprintf(title, 128, "%.60s is admitted", v->person);
    } else {
        (void)snprintf(title, 128, "Refused: %.20s", v->reason);
    }
    (void)snprintf(subtitle, 256, "visit %.60s by %.60s; decided by %u usable frames; the door %s",
                   visit->row->recording, came, v->frames,
                   visit->unlocked ? "was unlocked" : "stayed locked");
}

int sim_visit_picture(const struct sim_trace *trace, const struct sim_visit *visit,
                      const struct iso_gallery *gallery, const char *path, struct iso_fault *fault)
{
    char title[128], subtitle[256], words[SIM_TRACE_FRAMES][WORD_SIZE];
    struct sim_visit_frame frames[SIM_TRACE_FRAMES];
    struct sim_visit_switch switches[SIM_TRACE_SWITCHES];
    struct sim_visit_view view = {
        .title = title,
        .subtitle = subtitle,
        .allowed = visit->verdict.given && visit->verdict.allow,
        .n_frames = trace->n_frames,
        .frames = frames,
        .threshold = visit->verdict.threshold,
        .decided = trace->decided,
        .verdict_s = seconds(trace, trace->verdict_ns),
        .end_s = seconds(trace, trace->end_ns),
        .n_switches = trace->n_switches,
        .switches = switches,
    };
    for (int i = 0; i < trace->n_frames; i++) {
        const struct sim_trace_frame *note = &trace->frames[i];
        describe_frame(note, gallery, words[i]);
        frames[i] = (struct sim_visit_frame){
            .frame = note->frame,
            .landmark_mm = note->fitted ? note->landmark_mm : NULL,
            .ibug_mm = note->fitted ? note->ibug_mm : NULL,
            .t_s = seconds(trace, note->frame->t_ns),
            .scored = note->compared,
            .score = note->score,
            .word = words[i],
        };
    }
    for (int i = 0; i < trace->n_switches; i++) {
        switches[i] = (struct sim_visit_switch){seconds(trace, trace->relay[i].t_ns),
                                                trace->relay[i].active};
    }
    describe_visit(visit, title, subtitle);
    return sim_picture_visit(&view, path, fault);
}
