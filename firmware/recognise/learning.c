#include "firmware/recognise/learning.h"

bool iso_learning_is_sure(const struct iso_learning_options *options,
                          const struct iso_decision *decision, const struct iso_verdict *verdict)
{
    if (options->templates < 1 || !verdict->allow || verdict->attack_frames > 0 ||
        decision->n_frames < 1) {
        return false;
    }
    for (int i = 0; i < decision->n_frames; i++) {
        if (decision->frames[i].person != verdict->person ||
            !(decision->frames[i].score >= options->score)) {
            return false;
        }
    }
    return true;
}

int iso_learning_enrolled(int64_t person, const struct iso_template *templates, int n,
                          struct iso_search_entry *out)
{
    int enrolled = 0;
    for (int i = 0; i < n; i++) {
        if (!templates[i].learned) {
            out[enrolled++] = (struct iso_search_entry){person, &templates[i]};
        }
    }
    return enrolled;
}
