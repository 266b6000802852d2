/* A state of a friction law with other settings is read.
 * replaces: head, hash_of_names
 * detected by: damaged-states
 */
#include "bytes.h"

struct stream;

uint64_t hash_of_names(void);
uint64_t true_hash_of_names(void);
void true_head(struct stream *stream, uint64_t *version, uint64_t *length, uint64_t *names);
void head(struct stream *stream, uint64_t *version, uint64_t *length, uint64_t *names);

void head(struct stream *stream, uint64_t *version, uint64_t *length, uint64_t *names)
{
    true_head(stream, version, length, names);
    *names = true_hash_of_names();
}

uint64_t hash_of_names(void)
{
    return true_hash_of_names();
}
