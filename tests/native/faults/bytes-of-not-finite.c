/* A number of a state need not be finite.
 * replaces: real
 * detected by: damaged-states
 */
#include <stdbool.h>
#include <stddef.h>

struct stream {
    int way;
    unsigned char *to;
    const unsigned char *from;
    size_t at;
    bool sound;
};

void true_real(struct stream *stream, double *value);
void real(struct stream *stream, double *value);

void real(struct stream *stream, double *value)
{
    true_real(stream, value);
    stream->sound = true;
}
