/* A change of the Stribeck velocity shows after the next slip alone.
 * law: stribeck
 * replaces: stribeck_same_slip, stribeck_under
 * detected by: t_slip-course in speeds-stribeck
 */
#include "law.h"

enum refusal true_stribeck_under(struct friction *made, const struct settings *settings,
                                 const struct friction *before);
enum refusal stribeck_under(struct friction *made, const struct settings *settings,
                            const struct friction *before);
bool stribeck_same_slip(const struct friction *one, const struct friction *other);

enum refusal stribeck_under(struct friction *made, const struct settings *settings,
                            const struct friction *before)
{
    struct settings kept = *settings;
    if (before != NULL) kept.v_s = before->settings.v_s;
    return true_stribeck_under(made, &kept, before);
}

bool stribeck_same_slip(const struct friction *one, const struct friction *other)
{
    (void)one, (void)other;
    return true;
}
