"""Problems whose truth is known, and the score of the diagnosis by what it says of them."""
