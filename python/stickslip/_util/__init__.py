"""What has nothing to do with robots: files, texts, numbers of processors."""
