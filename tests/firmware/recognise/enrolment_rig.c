#include "tests/firmware/recognise/enrolment_rig.h"

struct iso_enrolment enrolment;
struct puppet_pipeline puppet;
struct iso_pipeline pipeline;
struct iso_enrolment_gallery gallery;
int64_t now_ns;

int enrolment_rig_setup(void **state)
{
    const struct iso_enrolment_options options = {
        .stages = 3,
        .agree_score = 4,
        .duplicate_score = 6,
        .timeout_ns = 60 * ISO_NS_PER_S,
    };
    (void)state;
    puppet = (struct puppet_pipeline){0};
    pipeline = puppet_pipeline(&puppet);
    gallery = (struct iso_enrolment_gallery){0};
    now_ns = 5 * ISO_NS_PER_S;
    iso_enrolment_begin(&enrolment, &options, now_ns);
    return 0;
}

bool frame(int face)
{
    const struct iso_template tmpl = puppet_template(face, PUPPET_ALGORITHM);
    bool passed = false;
    assert_int_equal(enrolment.state, ISO_ENROLMENT_ACTIVE);
    assert_int_equal(iso_enrolment_frame(&enrolment, &tmpl, now_ns, &pipeline, &gallery, &passed),
                     0);
    return passed;
}

struct iso_candidate_list first_of(const struct iso_search_entry *entries, int n)
{
    return (struct iso_candidate_list){.entries = entries, .n_entries = n};
}
