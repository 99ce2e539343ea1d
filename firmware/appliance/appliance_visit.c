/* Whom a visit may let in: the options of the decision, the threshold, and who is valid now. */
#include "firmware/appliance/appliance_access.h"
#include "firmware/appliance/appliance_calls.h"

struct iso_decision_options iso__appliance_decision_options(const struct iso_config *config)
{
    const struct iso_config_decision *decision = &config->decision;
    return (struct iso_decision_options){
        .threshold = iso_config_threshold(config),
        .margin = decision->margin,
        .agree = decision->agree,
        .max_frames = decision->max_frames,
        .attack_frames = decision->attack_frames,
        .gap_ns = decision->gap_ms * ISO_NS_PER_MS,
        .refractory_ns = decision->refractory_ms * ISO_NS_PER_MS,
        .stale_ns = config->sensor.stale_ms * ISO_NS_PER_MS,
    };
}

double iso__appliance_threshold(const struct iso_appliance *appliance)
{
    size_t n_people = 1;
    if (appliance->mode != ISO_APPLIANCE_VERIFY && !iso__appliance_only_person(appliance)) {
        (void)iso_gallery_people(appliance->borrowed.gallery, &n_people);
    }
    return iso_config_threshold_among(
        appliance->borrowed.config, n_people,
        iso_site_is_provisional(iso_gallery_site(appliance->borrowed.gallery)));
}

bool iso__appliance_is_valid(const struct iso_appliance *appliance, int64_t person_id)
{
    const struct iso_person *person = iso_gallery_find_id(appliance->borrowed.gallery, person_id);
    return person && iso_person_is_valid(person, iso__appliance_knows_date(appliance),
                                         iso__appliance_date_s(appliance));
}

size_t iso__appliance_count_valid(const struct iso_appliance *appliance)
{
    const bool time_known = iso__appliance_knows_date(appliance);
    const int64_t now_s = iso__appliance_date_s(appliance);
    size_t n = 0, valid = 0;
    const struct iso_person *people = iso_gallery_people(appliance->borrowed.gallery, &n);
    for (size_t i = 0; i < n; i++) {
        valid += iso_person_is_valid(&people[i], time_known, now_s);
    }
    return valid;
}
